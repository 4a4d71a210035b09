#!/bin/sh
# Tables for the Bandai-Namco Research Motiondataset (CC BY-NC 4.0: measure with it, do not ship what is made of it) from the names
# of its files, dataset-<set>_<content>_<style>_<number>.bvh.
#
#     examples/training/bandai.sh FOLDER [SET]      writes these tables into the current folder:
#
# captions.tsv: what is done and in which style, six wordings of it; actions.tsv: what is done and by which parts of the body, four
# wordings without the style; labels.tsv: what is done, as a label; captions_four.tsv: four wordings that differ in who does it;
# captions_one.tsv: one of these four for each clip, so that the same is said in different words of different clips. SET 2
# (10 contents in 7 styles) unless another is named. A clip goes from its beginning to its end, 10 s at most.
set -e
folder=$1 set=${2:-2}
[ -d "$folder" ] || { echo "usage: bandai.sh FOLDER [SET]" >&2; exit 2; }
for file in "$folder"/dataset-"$set"_*.bvh; do
  awk -v name="$(basename "$file" .bvh)" '
    /^Frames:/ { frames = $2 }
    /^Frame Time:/ { printf "%s\t0\t%.3f\n", name, (frames * $3 > 10 ? 10 : frames * $3); exit }' "$file"
done | awk -F '\t' '
  BEGIN {
    split("walk|walks|walking|walk-turn-left|walks and turns left|walking and turning left|" \
          "walk-turn-right|walks and turns right|walking and turning right|walk-back|walks backwards|walking backwards|" \
          "run|runs|running|dash|dashes forward|dashing forward|" \
          "wave-both-hands|waves both hands|waving both hands|wave-left-hand|waves the left hand|waving the left hand|" \
          "wave-right-hand|waves the right hand|waving the right hand|raise-up-both-hands|raises both hands|raising both hands|" \
          "raise-up-left-hand|raises the left hand|raising the left hand|" \
          "raise-up-right-hand|raises the right hand|raising the right hand|bow|bows|bowing|" \
          "bye|waves goodbye|waving goodbye|byebye|waves goodbye with both hands|waving goodbye with both hands|" \
          "guide|shows the way|showing the way|respond|answers|answering|call|calls|calling|kick|kicks|kicking|" \
          "punch|punches|punching|slash|slashes|slashing|dance-short|dances|dancing|dance-long|dances|dancing", list, "|")
    for (i = 1; i in list; i += 3) { verb[list[i]] = list[i + 1]; ing[list[i]] = list[i + 2] }
    split("normal|normally|active|actively|elderly|like an elderly person|exhausted|in an exhausted way|" \
          "feminine|in a feminine way|masculine|in a masculine way|youthful|like a young person", list2, "|")
    for (i = 1; i in list2; i += 2) manner[list2[i]] = list2[i + 1]
    print "# clip\tstart\tend\tparts\tcaption | caption | ..." > "captions.tsv"
    print "# clip\tstart\tend\tlabel" > "labels.tsv"
    print "# clip\tstart\tend\tparts\tcaption | caption | ..." > "actions.tsv"
  }
  function order(content) {  # walk-turn-left: walk and turn left; raise-up-left-hand: raise the left hand
    gsub(/-/, " ", content)
    sub(/^walk turn/, "walk and turn", content)
    sub(/^raise up/, "raise", content)
    sub(/left hand/, "the left hand", content)
    sub(/right hand/, "the right hand", content)
    return content
  }
  function parts(content) {
    return content ~ /both-hands/ ? "left arm, right arm" : content ~ /left-hand/ ? "left arm" : content ~ /right-hand/ ? "right arm" : "legs"
  }
  {
    split($1, part, "_")
    v = part[2] in verb ? verb[part[2]] : part[2]; g = part[2] in ing ? ing[part[2]] : part[2]
    m = part[3] in manner ? manner[part[3]] : "in a " part[3] " way"
    printf "%s\t%s\t%s\tlegs\ta person %s %s | someone %s %s | %s, a person %s | a human %s %s | %s %s | somebody is %s %s\n", \
           $1, $2, $3, v, m, v, m, m, v, v, m, g, m, g, m > "captions.tsv"
    printf "%s\t%s\t%s\t%s\n", $1, $2, $3, part[2] > "labels.tsv"
    printf "%s\t%s\t%s\t%s\t%s | a person %s | someone %s | %s\n", $1, $2, $3, parts(part[2]), order(part[2]), v, v, g > "actions.tsv"
    ++clips
  }
  END { printf "%d clips\n", clips }'
awk -v one=captions_one.tsv -v four=captions_four.tsv '
  BEGIN { FS = OFS = "\t"; split("a person|the person|a man|the man", who, "|") }
  /^#/ { print > one; print > four; next }
  {
    split($5, wording, " [|] "); does = wording[1]; sub(/^a person /, "", does)
    $5 = who[int((NR * 2654435761) % 4294967296 / 65536) % 4 + 1] " " does; print > one
    $5 = who[1] " " does
    for (i = 2; i <= 4; ++i) $5 = $5 " | " who[i] " " does
    print > four
  }' captions.tsv
