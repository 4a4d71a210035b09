#!/bin/sh
# Attacks the studio's server, and uses its page in headless Chromium.
#   run_studio_server.sh <program motionlang>
# Exit status: 0 passed, 1 failed, 77 skipped because a program is missing. Debian packages: chromium-driver (which brings
# chromium) and python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/programs.sh"
PYTHONDONTWRITEBYTECODE=1 python3 "$here/studio_server_test.py" "$(command -v chromedriver)" "$1" "$folder"
