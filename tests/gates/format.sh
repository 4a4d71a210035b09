#!/bin/sh
# Gate: every source is as clang-format 14 writes it, and no line has more than 120 columns, but where clang-format is off and
# in raw strings.
#     sh tests/gates/format.sh [FILE ...]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
if [ $# -eq 0 ]; then
  cd "$here/../.."
  set -- $(python3 "$here/files.py")
  [ $# -gt 100 ] || { echo "only $# sources found"; exit 1; }
fi
command -v clang-format-14 >/dev/null || { echo "clang-format-14 is needed (Debian: clang-format-14)"; exit 1; }
code=0
clang-format-14 --style="file:$here/../../.clang-format" --dry-run -Werror "$@" || code=1
awk '
  FNR == 1 { off = 0; raw = 0 }
  /clang-format off/ { off = 1 }
  /clang-format on/ { off = 0 }
  /R"[a-z]*\(/ { raw = 1 }
  length($0) > 120 && !off && !raw { print FILENAME ":" FNR ": " length($0) " columns"; wrong = 1 }
  /\)[a-z]*"/ { raw = 0 }
  END { exit wrong }' "$@" || code=1
[ $code -ne 0 ] || echo "$# files are formatted"
exit $code
