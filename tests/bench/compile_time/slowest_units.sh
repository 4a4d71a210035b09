#!/bin/sh
# The twenty units that took longest to compile, and seconds by program: slowest_units.sh <build folder of Ninja>
# By the clock, so after a build on a quiet machine and without ccache's help.
set -eu
log=$1/.ninja_log
[ -e "$log" ] || { echo "no $log: only Ninja writes down how long it took"; exit 1; }
units() {
  awk -F'\t' '!/^#/ && $4 ~ /\.o$|\.gch$/ { seconds[$4] = ($2 - $1) / 1000 }
              END { for (unit in seconds) printf "%8.1f %s\n", seconds[unit], unit }' "$log"
}
units | sort -rn | head -20 | sed 's|CMakeFiles/||; s|\.dir/| |'
echo
units | sed 's|CMakeFiles/||; s|\.dir/.*||' | awk '
  { seconds[$2] += $1; units[$2]++; all += $1; count++ }
  END { for (program in seconds) printf "%8.1f %4d units of %s\n", seconds[program], units[program], program | "sort -rn | head -20"
        close("sort -rn | head -20"); printf "%8.1f %4d units in all\n", all, count }'
