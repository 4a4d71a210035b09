#!/bin/sh
# The gates that every submission passes: format, words and links of the whole tree, and sanitizers on all readers. The rest,
# clang-tidy (check_tidy) among it: cmake --build build/ci --target check_all
set -eu
cd "$(dirname "$0")/../.."
. .ci/packages.sh
need python3 clang-format-14
sh tests/gates/format.sh
python3 tests/gates/words.py
python3 tests/gates/links.py
sh tests/gates/sanitizers.sh
echo "All gates passed."
