#!/bin/sh
# Puts the gestures of the folder gestures into the memory of weights, over figures that these let stand or walk.
#
#     examples/training/remember.sh WEIGHTS NEW_WEIGHTS [MOTIONLANG [FOLDER]]
#
# MOTIONLANG is the program; the default is the one in PATH. FOLDER gets the clips and their table, captions.tsv, to
# train other models with; without it they are not kept. Needs Python 3 with NumPy. Two figures stand with hanging arms,
# and two walk, so every gesture has two motions. No recorded clip goes into the weights.
set -e
weights=$1 new=$2 program=${3:-motionlang} kept=$4
[ -f "$weights" ] && [ -n "$new" ] || { echo "usage: remember.sh WEIGHTS NEW_WEIGHTS [MOTIONLANG [FOLDER]]" >&2; exit 2; }
scripts=$(dirname "$0")
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
echo "stand with hanging arms # 0 # 7" > "$folder/standing.txt"
echo "walk forward # 0 # 6" > "$folder/walking.txt"
set --
for base in standing walking; do
  for seed in 1 3; do
    "$program" generate --timeline "$folder/$base.txt" --seed $seed --model "$weights" --recall 0 --out "$folder/$seed"
    set -- "$@" "$folder/$seed/$base.npz"
  done
  [ $base = walking ] || set -- "$@" --walking
done
python3 "$scripts/gestures" "$@" "$folder/clips/gestures"
python3 "$scripts/gestures" --captions 2 2 > "$folder/captions.tsv"
"$program" remember --model "$weights" --captions "$folder/captions.tsv" --data "$folder/clips" --output "$new"
if [ -n "$kept" ]; then
  mkdir -p "$kept"
  cp -R "$folder/clips/gestures" "$folder/captions.tsv" "$kept"
fi
