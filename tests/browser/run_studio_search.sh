#!/bin/sh
# Opens the studio in headless Chromium, and searches motions by words there.
#   run_studio_search.sh <studio.html>
# Exit status: 0 passed, 1 failed, 77 skipped because a program is missing. Debian packages: chromium-driver (which brings
# chromium) and python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/programs.sh"
PYTHONDONTWRITEBYTECODE=1 python3 "$here/studio_search_test.py" "$(command -v chromedriver)" "$1" "$folder"
