#!/bin/sh
# Opens a viewer page in headless Chromium, once with WebGL and once without, presses its buttons and watches the pose.
#   run.sh <program that writes the page>
# Exit status: 0 passed, 1 failed, 77 skipped because a program is missing. Debian packages: chromium-driver (which brings
# chromium) and python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/programs.sh"
"$1" "$folder/page.html"
python3 "$here/viewer_test.py" "$(command -v chromedriver)" "$folder/page.html" "$here/probe.js"
