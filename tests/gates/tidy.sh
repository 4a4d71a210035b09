#!/bin/sh
# Gate: clang-tidy 14, with the checks of .clang-tidy, finds nothing in the headers. FILE may be a source, too.
#     sh tests/gates/tidy.sh all | changed | tenth | FILE ...
#
# changed   what differs from the last merge, or from TIDY_BASE
# tenth     every tenth file, other ones with every commit
#
# Headers of include/ are looked at together, in one unit that includes them, with their bodies (.ipp); sources one by one, with
# the options of the preset tidy. After TIDY_MINUTES no further unit is begun, and those left out are reported.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
. .ci/packages.sh
command -v clang-tidy-14 >/dev/null || { echo "clang-tidy-14 is needed (Debian: clang-tidy-14)"; exit 1; }
last_merge() { git rev-list --merges --max-count=1 HEAD^ 2>/dev/null || true; }
headers() { grep -E '^include/.*\.(hpp|ipp)$' || true; }
case ${1:-all} in
  all) files=$(python3 "$here/files.py" | headers) ;;
  changed)
    base=${TIDY_BASE:-$(last_merge)}
    [ -n "$base" ] || { echo "clang-tidy: no merge is known here, so nothing counts as changed"; exit 0; }
    files=$(git diff --name-only --diff-filter=d "$base" | headers)
    ;;
  tenth) files=$(python3 "$here/files.py" | headers | awk -v n="$(git rev-list --count HEAD)" 'NR % 10 == n % 10') ;;
  *) files=$* ;;
esac
configure tidy
folder=build/tidy/gate
mkdir -p $folder
# shellcheck disable=SC2086
python3 "$here/tidy_commands.py" build/tidy $files >$folder/units.txt
echo "clang-tidy looks at $(echo "$files" | wc -w) files in $(wc -l <$folder/units.txt) units"
deadline=$(($(date +%s) + ${TIDY_MINUTES:-10000} * 60))
xargs -a $folder/units.txt -P "$(nproc)" -I{} sh -c '
  [ "$(date +%s)" -lt "$1" ] || { echo "left out, for time: {}"; exit 0; }
  clang-tidy-14 --quiet -p "$0" --header-filter="$(cat "$0/headers.txt")" "{}" 2>/dev/null' "$folder" "$deadline"
