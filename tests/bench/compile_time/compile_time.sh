#!/bin/bash
# What the headers cost a user: compile_time.sh <compiler and flags...>
# Prints seconds of user time (the best of three) and preprocessed lines. Fails if a unit of a user is over its limit.
cd "$(dirname "$0")" || exit
compile=("$@")
TIMEFORMAT=%U

# seconds <flags...>: of the text on standard input
seconds() {
  local text
  text=$(cat)
  for _ in 1 2 3; do
    { time "${compile[@]}" "$@" -x c++ - <<<"$text" >/dev/null 2>&1; } 2>&1
  done | sort -n | head -1
}
# row <label> <includes> <flags...>
row() {
  local label=$1 includes=$2 text
  shift 2
  text=$(printf '#include <%s>\n' $includes)
  printf '%-38s %7s %9s\n' "$label" "$(seconds "$@" -fsyntax-only <<<"$text")" \
    "$("${compile[@]}" "$@" -E -x c++ - <<<"$text" | wc -l)"
}
# unit <label> <limit> <flags...>
unit() {
  local label=$1 limit=$2 time
  shift 2
  time=$(seconds "$@" -O0 -c -o /dev/null <user.cpp)
  printf '%-38s %7s %9s\n' "$label" "$time" "limit $limit"
  awk "BEGIN { exit !($time <= $limit) }" || status=1
}

status=0
printf '%-38s %7s %9s\n' include seconds lines
row '<vector> <string> <memory> <span>' 'vector string memory concepts span'
row Eigen/Core Eigen/Core
row nlohmann/json.hpp nlohmann/json.hpp
for header in fwd core/rng tensor/ops tensor/fused geometry/so3 kinematics/forward nn/transformer_encoder backend/reference \
  backend/eigen backend/xtensor backend/autodiff compose/timeline_text io/bvh io/json motionlang stmc; do
  row "motionlang/$header.hpp" "motionlang/$header.hpp"
done
row 'motionlang/stmc.hpp, instantiated' motionlang/stmc.hpp -DMOTIONLANG_INSTANTIATED
echo
printf '%-38s %7s\n' 'unit of a user, -O0' seconds
unit 'header-only' 3
unit 'motionlang::instantiated' 1.5 -DMOTIONLANG_INSTANTIATED
exit $status
