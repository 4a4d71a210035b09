#!/bin/sh
# Gate: clang-tidy 14, with the checks of .clang-tidy, has nothing to say of a source or a header alone.
#     sh tests/gates/tidy.sh all | changed | tenth | FILE ...      in front: the compiler's options, in TIDY_OPTIONS
#
# changed   what differs from the last merge (TIDY_BASE names another commit)
# tenth     every tenth file, other ones with every commit
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
. "$here/sources.sh"
command -v clang-tidy-14 >/dev/null || { echo "clang-tidy-14 is needed (Debian: clang-tidy-14)"; exit 1; }
base=${TIDY_BASE:-$(git rev-list --merges --max-count=1 --skip="$(git rev-list --merges --max-count=1 HEAD | grep -c "$(git rev-parse HEAD)" || true)" HEAD)}
ours() { grep -E '^(include|examples|tests/(unit|laws|ops|systems|program|support|golden))/.*\.(hpp|cpp|c)$' || true; }
case ${1:-all} in
  all) files=$(sources | ours) ;;
  changed) files=$(git diff --name-only --diff-filter=d "${base:-HEAD}" | ours) ;;
  tenth) files=$(sources | ours | awk -v n="$(git rev-list --count HEAD)" 'NR % 10 == n % 10') ;;
  *) files=$* ;;
esac
[ -n "$files" ] || { echo "nothing to look at"; exit 0; }
echo "clang-tidy looks at $(echo "$files" | wc -w) files"
# shellcheck disable=SC2086
echo $files | tr ' ' '\n' | xargs -P "$(nproc)" -n 1 clang-tidy-14 --quiet --extra-arg-before=-xc++ "{}" -- ${TIDY_OPTIONS:-}
