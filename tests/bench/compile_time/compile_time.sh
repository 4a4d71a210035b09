#!/bin/bash
# Measures how long a user compiles the headers: compile_time.sh [--table] [--kept FILE] <compiler and flags...>
#
# Compiles the unit of a user in several ways and prints each time (user seconds) and its ratio to three packages together,
# <Eigen/Dense>, <nlohmann/json.hpp> and <xtensor/xarray.hpp>, measured in the same run. Fails if a ratio is more than 1.2
# times what kept.txt says in all of four tries. Each new try measures the packages again directly before the unit: a
# busy machine is slow for both. Says if a ratio is less than 0.8 times what is kept: then keep the new one.
# --table: measures single headers, too.
here=$(cd "$(dirname "$0")" && pwd)
kept=$here/kept.txt
table=0
while [ $# -gt 0 ]; do
  case $1 in
    --table) table=1 && shift ;;
    --kept) kept=$2 && shift 2 ;;
    *) break ;;
  esac
done
compile=("$@")
TIMEFORMAT=%U
[ -r "$kept" ] || { echo "cannot read $kept"; exit 1; }

# seconds <flags...>: of the text on standard input. Without a result if it does not compile.
seconds() {
  local time
  time=$({ time "${compile[@]}" "$@" -x c++ - >/dev/null 2>&3; } 3>&2 2>&1) && echo "$time"
}
# least <flags...>: the best of two.
least() {
  local text first second
  text=$(cat)
  first=$(seconds "$@" <<<"$text") && second=$(seconds "$@" <<<"$text") && printf '%s\n' "$first" "$second" | sort -n | head -1
}
includes() { printf '#include <%s>\n' "$@"; }

if [ $table -eq 1 ]; then
  printf '%-38s %7s %9s\n' include seconds lines
  for header in Eigen/Core nlohmann/json.hpp motionlang/{fwd,core/rng,tensor/ops,tensor/fused,geometry/so3,kinematics/forward}.hpp \
    motionlang/{nn/transformer_encoder,backend/reference,backend/eigen,backend/xtensor,backend/autodiff}.hpp \
    motionlang/{compose/timeline_text,formats/bvh,file/json,motionlang,stmc}.hpp; do
    printf '%-38s %7s %9s\n' "$header" "$(seconds -fsyntax-only < <(includes "$header"))" \
      "$("${compile[@]}" -E -x c++ - < <(includes "$header") | wc -l)"
  done
  echo
fi

status=0
rows=0
compile_packages() { "$1" -O0 -c -o /dev/null < <(includes Eigen/Dense nlohmann/json.hpp xtensor/xarray.hpp); }
packages=$(compile_packages least)
[ -n "$packages" ] || { echo "the three packages do not compile"; exit 1; }
printf '%-34s %7s %7s %7s\n' "unit of a user" seconds ratio kept
printf '%-34s %7s %7s\n' "the three packages, -O0" "$packages" 1
while read -r ratio flags; do
  [ "${ratio:0:1}" = "#" ] && continue
  now=
  beside=$packages
  for try in 1 2 3 4; do
    [ "$try" -eq 1 ] || beside=$(compile_packages seconds)
    # shellcheck disable=SC2086
    time=$(seconds $flags -c -o /dev/null <"$here/user.cpp")
    [ -n "$time" ] || { echo "user.cpp does not compile with $flags"; exit 1; }
    # shellcheck disable=SC2086
    now=$(printf '%s\n' $now "$(awk "BEGIN { printf \"%.2f\", $time / $beside }")" | sort -n | head -1)
    awk "BEGIN { exit !($now > 1.2 * $ratio) }" || break
  done
  rows=$((rows + 1))
  printf '%-34s %7s %7s %7s' "$flags" "$time" "$now" "$ratio"
  if awk "BEGIN { exit !($now > 1.2 * $ratio) }"; then
    printf '   more than 1.2 times what is kept' && status=1
  elif awk "BEGIN { exit !($now < 0.8 * $ratio) }"; then
    printf '   faster: keep it in %s' "$(basename "$kept")"
  fi
  echo
done <"$kept"
[ $rows -gt 0 ] || { echo "$kept keeps nothing"; exit 1; }
exit $status
