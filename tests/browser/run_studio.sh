#!/bin/sh
# Opens the studio in headless Chromium and uses it.
#   run_studio.sh <studio.html> <program motionlang> <the page's model>
# Exit status: 0 passed, 1 failed, 77 skipped because a program is missing. Debian packages: chromium-driver (which brings
# chromium) and python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/programs.sh"
PYTHONDONTWRITEBYTECODE=1 python3 "$here/studio_test.py" "$(command -v chromedriver)" "$1" "$2" "$3" "$folder"
