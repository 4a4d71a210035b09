#!/bin/sh
# Runs every fuzzer, one after another, and stops at the first finding; the input that shows it is left in the build folder.
#
#     sh tests/fuzz/run.sh [RUNS [NAME ...]]        10,000,000 runs of each; names: bvh npy ...; needs clang
#
# No allocation may be above twice the size of the file and 64 MiB: files have at most 4 KiB here.
set -eu
cd "$(dirname "$0")/../.."
runs=${1:-10000000}
[ $# -eq 0 ] || shift
build=${MOTIONLANG_FUZZ_BUILD:-build/fuzz}
cmake -S . -B "$build" -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DMOTIONLANG_BUILD_FUZZERS=ON -DMOTIONLANG_BUILD_EXAMPLES=OFF \
  > /dev/null
[ $# -gt 0 ] || set -- $(ls tests/fuzz/fuzz_*.cpp | sed 's/.*fuzz_\(.*\)\.cpp/\1/')
for name in "$@"; do
  cmake --build "$build" --target "fuzz_$name" > /dev/null
  mkdir -p "$build/corpus/$name"  # what the fuzzer adds
  echo "fuzz_$name: $runs runs"
  "$build/tests/fuzz/fuzz_$name" -runs="$runs" -max_len=4096 -timeout=20 -rss_limit_mb=2048 -malloc_limit_mb=65 \
    -print_final_stats=1 -verbosity=0 -artifact_prefix="$build/finding_$name-" "$build/corpus/$name" "tests/fuzz/corpus/$name" \
    > "$build/$name.log" 2>&1 ||
    { tail -n 40 "$build/$name.log"; exit 1; }
  grep -E "^stat::(number|average)" "$build/$name.log"
done
echo "no findings"
