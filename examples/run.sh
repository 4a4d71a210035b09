#!/bin/sh
# The main job: installs what is missing, builds the motionlang program, and makes a motion from a timeline of texts with the
# weights that come with the repository. Other timelines: sh examples/run.sh FILE [options of 'motionlang generate'].
set -eu
timeline=examples/timelines/walk_and_raise_arms.txt
if [ $# -gt 0 ]; then
  timeline=$(realpath "$1")
  shift
fi
cd "$(dirname "$0")/.."
. .ci/packages.sh
command -v c++ >/dev/null || need g++
need cmake ninja-build libeigen3-dev libxtensor-dev nlohmann-json3-dev libcli11-dev libhnswlib-dev
options="-DMOTIONLANG_BUILD_TESTS=OFF -DMOTIONLANG_TRAINING=OFF"  # examples/motionlang/README.md tells how to add train-tmr and the others
build release motionlang_program
echo
cat "$timeline"
echo
exec build/release/examples/motionlang generate --timeline "$timeline" --out out "$@"
