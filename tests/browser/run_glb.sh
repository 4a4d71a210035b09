#!/bin/sh
# Opens GLB files in three.js in headless Chromium and compares the places of bones with forward kinematics.
#   run_glb.sh <program that writes the files>
# Exit status: 0 passed, 1 failed, 77 skipped because a program or three.js is missing. Debian packages: chromium-driver
# (which brings chromium), python3 and npm. three.js comes from npm into a temporary folder, unless MOTIONLANG_THREE names
# a folder with its package.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/programs.sh"
three=${MOTIONLANG_THREE:-}
if [ -z "$three" ]; then
  if ! timeout 120 npm install --silent --no-audit --no-fund --prefix "$folder" three@0.187.0 > "$folder/npm.log" 2>&1; then
    echo "skipped: no three.js (npm: $(tail -n 1 "$folder/npm.log"))"
    exit 77
  fi
  three=$folder/node_modules/three
fi
"$1" "$folder"
PYTHONDONTWRITEBYTECODE=1 python3 "$here/glb_test.py" "$(command -v chromedriver)" "$three" "$folder"
