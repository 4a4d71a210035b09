#!/bin/sh
# The gates that every submission passes: format, words and links of the whole tree; clang-tidy on what changed since the
# last merge and on another tenth of the tree every time; sanitizers on all readers. After GATE_MINUTES (default 40)
# nothing long is begun, and what is left out is reported.
# The whole of it: cmake --build build/ci --target check_all
set -eu
cd "$(dirname "$0")/../.."
. .ci/packages.sh
need python3 clang-format-14 clang-tidy-14
sh tests/gates/format.sh
python3 tests/gates/words.py
python3 tests/gates/links.py
python3 tests/gates/reproduce.py
end=$(($(date +%s) + ${GATE_MINUTES:-40} * 60))
minutes_left() {
  seconds=$((end - $(date +%s)))
  echo $((seconds > 0 ? seconds / 60 : 0))
}
TIDY_MINUTES=$(($(minutes_left) / 5)) sh tests/gates/tidy.sh changed
TIDY_MINUTES=$(($(minutes_left) / 4)) sh tests/gates/tidy.sh tenth
SANITIZER_MINUTES=$(minutes_left) sh tests/gates/sanitizers.sh
echo "All gates passed, except for what was left out above for time."
