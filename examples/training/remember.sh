#!/bin/sh
# Puts the gestures of gestures.py into the memory of weights, over figures that these weights let stand or walk.
#
#     examples/training/remember.sh WEIGHTS NEW_WEIGHTS [MOTIONLANG]
#
# MOTIONLANG is the program; the default is the one in PATH. Needs Python 3 with NumPy. Four figures stand with hanging
# arms, and four walk, so every gesture has four motions. No recorded clip goes into the weights.
set -e
weights=$1 new=$2 program=${3:-motionlang}
[ -f "$weights" ] && [ -n "$new" ] || { echo "usage: remember.sh WEIGHTS NEW_WEIGHTS [MOTIONLANG]" >&2; exit 2; }
scripts=$(dirname "$0")
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
echo "stand with hanging arms # 0 # 7" > "$folder/standing.txt"
echo "walk forward # 0 # 6" > "$folder/walking.txt"
set --
for base in standing walking; do
  for seed in 1 3 5 7; do
    "$program" generate --timeline "$folder/$base.txt" --seed $seed --model "$weights" --recall 0 --out "$folder/$seed"
    set -- "$@" "$folder/$seed/$base.npz"
  done
  [ $base = walking ] || set -- "$@" --walking
done
python3 "$scripts/gestures.py" "$@" "$folder/clips/gestures"
python3 "$scripts/gestures.py" --captions 4 4 > "$folder/captions.tsv"
"$program" remember --model "$weights" --captions "$folder/captions.tsv" --data "$folder/clips" --output "$new"
