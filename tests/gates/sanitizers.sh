#!/bin/sh
# Gate: no reader has an error of memory, undefined behaviour or a leak on what the tests and the fuzzers' corpora feed it.
#     sh tests/gates/sanitizers.sh [TEST ...]      programs of tests/; without: all that read files
#
# After SANITIZER_MINUTES no further program is begun, and those left out are reported. Each commit begins with another
# one.
set -eu
cd "$(dirname "$0")/../.."
. .ci/packages.sh
if [ $# -eq 0 ]; then
  set -- unit_file unit_formats unit_datasets unit_weights unit_text unit_compose unit_search unit_view \
    systems_official_folders systems_weight_limits \
    $(cd tests/fuzz && ls fuzz_*.cpp | sed 's/fuzz_\(.*\)\.cpp/replay_\1/')
  turn=$(($(git rev-list --count HEAD 2>/dev/null || echo 0) % $#))
  while [ $turn -gt 0 ]; do
    first=$1
    shift
    set -- "$@" "$first"
    turn=$((turn - 1))
  done
fi
configure sanitizers
deadline=$(($(date +%s) + ${SANITIZER_MINUTES:-10000} * 60))
log=$(mktemp)
trap 'rm -f "$log"' EXIT
code=0
for test in "$@"; do
  [ "$(date +%s)" -lt "$deadline" ] || { echo "left out, for time: $test"; continue; }
  cmake --build build/sanitizers -j "$(nproc)" --target "$test"
  corpus=
  case $test in replay_*) corpus=$PWD/tests/fuzz/corpus/${test#replay_} ;; esac
  program=$(find build/sanitizers/tests -name "$test" -type f)
  # shellcheck disable=SC2086
  if "$program" $corpus >"$log" 2>&1; then
    echo "$test: no error"
  else
    tail -40 "$log"
    echo "$test: failed"
    code=1
  fi
done
exit $code
