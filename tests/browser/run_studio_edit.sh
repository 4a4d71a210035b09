#!/bin/sh
# Opens the studio in headless Chromium and edits there, as studio_edit_test.py says.
#   run_studio_edit.sh <studio.html> <program motionlang> <program browser_glb>
# Exit status: 0 passed, 1 failed, 77 skipped because a program is missing. Debian packages: chromium-driver (which brings
# chromium) and python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/programs.sh"
"$3" "$folder"
mv "$folder/character.glb" "$folder/character.vrm"
PYTHONDONTWRITEBYTECODE=1 python3 "$here/studio_edit_test.py" "$(command -v chromedriver)" "$1" "$2" "$folder"
