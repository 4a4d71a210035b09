#!/bin/sh
# The gates that every submission passes: format, words and links of the whole tree; clang-tidy on what changed since the last
# merge and on another tenth of the tree every time; sanitizers on all readers.
# The whole of it: cmake --build build/ci --target check_all
set -eu
cd "$(dirname "$0")/../.."
. .ci/packages.sh
need python3 clang-format-14 clang-tidy-14
sh tests/gates/format.sh
python3 tests/gates/words.py
python3 tests/gates/links.py
python3 tests/gates/reproduce.py
TIDY_MINUTES=8 sh tests/gates/tidy.sh changed
TIDY_MINUTES=8 sh tests/gates/tidy.sh tenth
sh tests/gates/sanitizers.sh
echo "All gates passed."
