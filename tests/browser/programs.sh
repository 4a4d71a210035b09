# Sourced by the tests: skips without the programs that they need, and makes `folder`, which goes at the end.
for program in chromium chromedriver python3; do
  if ! command -v "$program" > /dev/null; then
    echo "skipped: no $program"
    exit 77
  fi
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
