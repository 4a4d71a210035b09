#!/bin/sh
# Opens viewer pages in headless Chromium, once with WebGL and once without, presses its buttons and watches the pose. Then the
# pages of the gallery and of studies.
#   run.sh <program that writes the pages>
# Exit status: 0 passed, 1 failed, 77 skipped because a program is missing. Debian packages: chromium-driver (which brings
# chromium) and python3.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/programs.sh"
"$1" "$folder/page.html" "$folder/body.html" "$folder"
for page in page body; do
  echo "$page"
  python3 "$here/viewer_test.py" "$(command -v chromedriver)" "$folder/$page.html" "$here/probe.js"
done
python3 "$here/pages_test.py" "$(command -v chromedriver)" "$folder"
