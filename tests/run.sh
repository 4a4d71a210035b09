#!/bin/sh
# All tests: installs what is missing, builds every test and runs them.
set -eu
cd "$(dirname "$0")/.."
. .ci/packages.sh
command -v c++ >/dev/null || need g++
need cmake ninja-build ccache clang libc++-dev libc++abi-dev libeigen3-dev libxtensor-dev nlohmann-json3-dev libcli11-dev libhnswlib-dev doctest-dev libutf8proc-dev \
  chromium chromium-driver python3
need clang-format-14 clang-tidy-14  # apart: other systems have other versions, and leave these tests out
build ci
ctest --preset ci -j "$(nproc)" --progress --output-on-failure
echo "All tests passed. Next: sh examples/run.sh makes a motion; build/ci/tests holds the programs, tests/README.md explains them."
