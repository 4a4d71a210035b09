#!/bin/sh
# Trains and measures every system of the papers on the Bandai-Namco Research Motiondataset, and writes their tables as
# one page. The licence is CC BY-NC 4.0: measure with it, and do not ship what is made of it.
#
#     examples/training/bandai_all.sh FOLDER OUT [--splits LISTS] [--only CHAPTERS] [--quick]
#
# FOLDER has the clips, dataset-2_<content>_<style>_<number>.bvh. LISTS has train.txt, val.txt and test.txt with
# names of clips; without it a fifth of each content is for tests. CHAPTERS are some of "stmc actor temos tmr teach
# sinc tm2t". OUT gets tables, models and results, and a page with the tables of the papers. Nothing that OUT
# already has is made again, so the same command goes on where it stopped, also after Ctrl-C. The page is written
# after each chapter, and says which rows are missing. --quick tries every command with one epoch and tiny networks.
#
# The variable MOTIONLANG names the program, THREADS the number of threads (2), and NICE a command in front, such as
# "nice -n 15".
set -eu
usage() { echo "usage: bandai_all.sh FOLDER OUT [--splits LISTS] [--only CHAPTERS] [--quick]" >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
[ $# -ge 2 ] && [ -d "$1" ] || usage
clips=$(cd "$1" && pwd)
mkdir -p "$2"
out=$(cd "$2" && pwd)
shift 2
lists='' quick='' chapters='stmc actor temos tmr teach sinc tm2t'
while [ $# -gt 0 ]; do
  case $1 in
    --splits) lists=$(cd "$2" && pwd); shift 2 ;;
    --only) chapters=$2; shift 2 ;;
    --quick) quick=yes; shift ;;
    *) usage ;;
  esac
done
ls "$clips"/dataset-2_*.bvh > /dev/null || exit 2
program=${MOTIONLANG:-motionlang}
threads=${THREADS:-2}
cd "$out"
mkdir -p trained results

# full QUICK FULL: the second, or the first of a quick trial.
full() { if [ "$quick" ]; then echo "$1"; else echo "$2"; fi; }

# once NAME COMMAND...: a step that is not done again.
once() {
  step=$1; shift
  [ -f "$step.done" ] || { echo "== $step" >&2; "$@"; touch "$step.done"; }
}

motionlang() { ${NICE:-} "$program" "$@"; }

# train NAME COMMAND OPTIONS: trains into trained/NAME, and keeps the processor time.
train() {
  name=$1; shift
  [ ! -f "trained/$name/done" ] || return 0
  echo "== $name: motionlang $*" >&2
  mkdir -p "trained/$name"
  (
    trap : INT  # the program stops by itself, and its time counts
    code=0
    motionlang "$@" --out "trained/$name" --threads "$threads" --save-minutes 1 || code=$?
    times >> "trained/$name/times"
    exit $code
  )
  touch "trained/$name/done"
}

# measure NAME OPTIONS: what `evaluate` prints, into results/NAME.txt.
measure() {
  name=$1; shift
  [ ! -f "results/$name.txt" ] || return 0
  echo "== results/$name.txt: motionlang evaluate $*" >&2
  motionlang evaluate "$@" --threads "$threads" > "results/$name.part"
  mv "results/$name.part" "results/$name.txt"
}

# ---- tables

# A fifth of each content for tests, a twentieth for validation; or the given lists.
make_splits() {
  mkdir -p splits
  if [ "$lists" ]; then
    for part in train val test; do cp "$lists/$part.txt" "splits/$part.txt"; done
    return
  fi
  : > splits/train.txt; : > splits/val.txt; : > splits/test.txt
  awk -F '\t' '
    !/^#/ { n = count[$4]++; print $1 > ("splits/" (n % 5 == 4 ? "test" : n % 20 == 0 ? "val" : "train") ".txt") }' labels.tsv
}

# The pairs of each part: first clip, second clip, name, label, label, parts of the second, end of the first, end of the
# second.
# A quarter of the combinations "legs x hands" is kept out of the training, so that tests have unseen ones.
list_pairs() {  # after|together, number of pairs for training, validation, tests
  awk -F '\t' -v kind="$1" -v most="$2 $3 $4" '
    BEGIN { split("train val test", part, " "); split(most, limit, " ") }
    FILENAME ~ /splits\// { of[$1] = FILENAME; gsub(/^splits\/|\.txt$/, "", of[$1]); next }
    /^#/ || !($1 in of) || $3 >= 10 { next }
    { split($5, wording, " [|] ")
      clip = $1; label[clip] = wording[1]; parts[clip] = $4; end[clip] = $3
      if (!(wording[1] in number)) number[wording[1]] = total++
      p = of[clip]
      if (kind == "after" || $4 == "legs") first[p, ++firsts[p]] = clip
      if (kind == "after" || $4 != "legs") second[p, ++seconds[p]] = clip }
    END {
      for (q = 1; q <= 3; ++q) {
        p = part[q]; made = 0
        if (!seconds[p]) continue
        step = firsts[p] > limit[q] ? firsts[p] / limit[q] : 1
        for (i = 1; i <= firsts[p] && made < limit[q]; i += step) {
          a = first[p, int(i)]
          b = second[p, (int(i) * 7 + 3) % seconds[p] + 1]
          if (label[a] == label[b]) continue
          if (kind == "together" && p != "test" && (number[label[a]] + number[label[b]]) % 4 == 0) continue
          ++made
          printf "%s\t%s\t%s_%s_%03d\t%s\t%s\t%s\t%.3f\t%.3f\t%s\n",
                 a, b, kind, p, made, label[a], label[b], parts[b], end[a], end[b], p
        }
      }
    }' splits/train.txt splits/val.txt splits/test.txt actions.tsv > "$1.tsv"
}

# Motions of the pairs: clips joined one after another, or the legs of one with the arms of another.
make_pairs() {
  mkdir -p data
  tab=$(printf '\t')
  while IFS=$tab read -r first second name _ _ parts _; do
    if [ "$1" = after ]; then
      motionlang join "data/$first.bvh" "data/$second.bvh" --blend 0.3 -o "data/$name.npz"
    else
      motionlang compose "data/$first.bvh" "data/$second.bvh" --second "$parts" -o "data/$name.npz"
    fi > joined.log
  done < "$1.tsv"
}

# BABEL's form of pairs, and of single clips for `together`.
make_babel() {
  awk -F '\t' -v kind="$1" '
    function segment(text, from, to) {
      return sprintf("{\"raw_label\": \"%s\", \"proc_label\": \"%s\", \"seg_id\": \"\", \"act_cat\": null, ", text, text) \
             sprintf("\"start_t\": %s, \"end_t\": %s}", from, to)
    }
    function entry(name, seconds, labels) {
      printf "%s\"%s\": {\"babel_sid\": %d, \"url\": \"\", \"feat_p\": \"%s.npz\", ", n ? ",\n" : "{", name, n + 1, name
      printf "\"dur\": %.2f, \"seq_ann\": null, \"frame_ann\": {\"labels\": [%s]}}", seconds, labels
      ++n
    }
    FILENAME ~ /splits\// { known[$1]; next }
    FILENAME == "actions.tsv" {
      if (!/^#/ && $1 in known && $3 < 10) { split($5, wording, " [|] "); entry($1, $3, segment(wording[1], 0, $3)) }
      next
    }
    kind == "after" { entry($3, $7 + $8 - 0.3, segment($4, 0, $7) ", " segment($5, $7 - 0.3, $7 + $8 - 0.3)); next }
    { to = $7 < $8 ? $7 : $8; entry($3, to, segment($4, 0, to) ", " segment($5, 0, to)) }
    END { print "}" }' splits/train.txt splits/val.txt splits/test.txt $([ "$1" = after ] || echo actions.tsv) "$1.tsv" > "$1.json"
}

make_tables() {
  mkdir -p data
  for file in "$clips"/dataset-2_*.bvh; do ln -sf "$file" data; done
  sh "$here/bandai.sh" data
  make_splits
  list_pairs after "$(full 6 300)" "$(full 2 15)" "$(full 3 60)"
  list_pairs together "$(full 6 300)" "$(full 2 15)" "$(full 3 60)"
  make_pairs after
  make_pairs together
  make_babel after
  make_babel together
  for part in train val test; do
    awk -F '\t' -v p=$part '$9 == p { print $3 }' after.tsv together.tsv >> splits/$part.txt
  done
  # texts of timelines, the recorded motion of each, and the answers that a language model would give about body parts
  awk -F '\t' '
    FNR == NR { test[$1]; next }
    /^#/ || !($1 in test) { next }
    { split($5, wording, " [|] ") }
    !seen[wording[1]]++ {
      gsub(/, /, " # ", $4)
      print wording[1] " # " $4 > "texts.txt"
      print $1 " # 0 # " $3 > "recorded.txt"
      gsub(/ # /, "\\n", $4)
      if ($4 == "legs") $4 = "right leg\\nleft leg\\nbuttocks"
      printf "%s\"%s\": [\"\", \"\", \"Answer: %s\"]", n++ ? ",\n" : "{", wording[1], $4 > "parts.json"
    }
    END { print "}" > "parts.json" }' splits/test.txt actions.tsv
  # for a judge that has seen two actions at the same time
  awk -F '\t' '
    FILENAME == "actions.tsv" { if (!/^#/) { split($5, wording, " [|] "); all[wording[1]] = $5 } print; next }
    { print $3 "\t0\t" ($7 < $8 ? $7 : $8) "\tlegs, " $6 "\t" all[$4] " | " all[$5] }' actions.tsv together.tsv > judged.tsv
}

# ---- trainings and measurements, by chapter

small="--preset small --splits splits --data data"
vae="--set network.latent_dim=$(full 8 64) --set network.ff_size=$(full 8 128)"
words="--set text.width=$(full 8 64)"
clips_too="--set data.min_seconds=0.3 --set data.mirror=false"
# Epochs for 936 clips; with fewer clips there are more, so that a training has as many steps.
epochs() {
  n=$(grep -c '^dataset' splits/train.txt) || { echo "bandai_all.sh: splits/train.txt names no clip" >&2; exit 2; }
  echo "--set optimiser.epochs=$(full 1 $((($1 * 936 + n - 1) / n)))"
}

table_stmc() {
  size="--set network.latent_dim=$(full 8 64) --set network.ff_size=$(full 8 256) --set network.num_layers=$(full 1 4) $words"
  train mdm_smpl train-mdm-smpl $small --captions actions.tsv --set data.min_seconds=0.5 $size \
    --set diffusion.steps="$(full 3 100)" --set optimiser.lr=0.001 $(epochs 160)
  judge="train-tmr $small --set data.min_seconds=0.3 $vae $words --set losses.threshold=0.95 $(epochs 30)"
  train judge $judge --captions actions.tsv
  train judge_of_pairs $judge --captions judged.tsv
  for judge in judge judge_of_pairs; do
    measure stmc_$judge trained/mdm_smpl/model --texts texts.txt --tmr trained/$judge/model --recorded recorded.txt \
      --data data --first "$(full 2 60)" --table markdown
  done
  measure overlap trained/mdm_smpl/model --texts texts.txt --tmr trained/judge/model --modes stmc --overlaps 0,0.25,0.5,1 \
    --first "$(full 2 60)" --table markdown
}

table_tmr() {
  tmr="train-tmr --captions captions_one.tsv $small $vae $words $clips_too --set features=rifke"
  tmr="$tmr --set optimiser.batch=$(full 4 128) $(epochs 80)"
  train tmr $tmr --set losses.threshold=0.88
  train tmr_unfiltered $tmr --set losses.threshold=0
  train tmr_margin $tmr --set losses.threshold=0.88 --set losses.contrastive_loss=margin
  train tmr_no_motions $tmr --set losses.threshold=0.88 --set losses.recons=0 --set network.vae=false
  train tmr_temos $tmr --set losses.contrastive_loss=none
  for model in tmr tmr_unfiltered tmr_margin tmr_no_motions tmr_temos; do
    measure $model trained/$model/model --data data --splits splits --captions captions_four.tsv
  done
}

table_temos() {
  temos="train-temos --captions captions.tsv $small $vae $words $clips_too --set optimiser.lr=0.001 $(epochs 50)"
  train temos $temos
  train temos_deterministic $temos --set network.vae=false
  train temos_no_encoder $temos --set network.motion_encoder=none
  train temos_no_embedding $temos --set losses.embedding=false
  train temos_no_cross $temos --set losses.cross_modal_kl=false
  train temos_no_priors $temos --set losses.gaussian_kl=false
  gru="--set network.motion_encoder=gru --set network.motion_decoder=gru"
  train temos_gru $temos $gru
  # In place of Lin et al. and JL2P, of which the thesis says little (2.2.2): deterministic, with GRUs for motions.
  train temos_lin $temos --set network.vae=false --set network.motion_encoder=none --set network.motion_decoder=gru
  train temos_jl2p $temos --set network.vae=false $gru
  for model in temos temos_deterministic temos_no_encoder temos_no_embedding temos_no_cross temos_no_priors temos_gru \
    temos_lin temos_jl2p; do
    measure $model trained/$model/model --data data --splits splits --captions captions.tsv --samples "$(full 2 10)"
  done
}

table_actor() {
  actor="train-actor --labels labels.tsv $small $vae --set network.num_layers=2 --set optimiser.lr=0.001"
  actor="$actor --set losses.kl=1e-4 $(epochs 100)"
  train classifier train-classifier --labels labels.tsv $small --set hidden_size="$(full 8 128)" $(epochs 30)
  train actor $actor
  train actor_rotations $actor --set losses.rcxyz=0
  train actor_joints $actor --set losses.rc=0
  train actor_gru $actor --set network.encoder=gru --set network.decoder=gru
  train actor_frames $actor --set network.encoder=frames --set network.decoder=frames --set network.latent_dim="$(full 8 32)"
  for model in actor actor_rotations actor_joints actor_gru actor_frames; do
    measure $model trained/$model/model --data data --splits splits --labels labels.tsv --classifier trained/classifier/model \
      --seeds "$(full 2 20)"
  done
}

table_teach() {
  babel="$small --babel after.json $vae $words --set optimiser.lr=0.001 $(epochs 50)"
  train teach train-teach $babel
  train independent train-sinc $babel --set data.types=seg --set data.proportion=0
  train joint train-sinc $babel --set data.types=separate_pairs --set data.proportion=0
  measure teach trained/teach/model --data data --splits splits --babel after.json --independent trained/independent/model \
    --joint trained/joint/model --samples "$(full 2 10)"
}

table_sinc() {
  babel="$small --babel together.json $vae $words --set optimiser.lr=0.001"
  train singles train-sinc $babel --set data.types=seg+seq $(epochs 40)
  train sinc_pairs train-sinc $babel --set data.types=spatial_pairs $(epochs 80)
  train sinc_ste train-sinc $babel --set data.types=spatial_pairs --set network.texts=separate $(epochs 80)
  train sinc train-sinc $babel --set data.types=seg+seq+spatial_pairs $(epochs 40)
  train sinc_synthetic train-sinc $babel --set data.types=seg+seq+spatial_pairs --set data.proportion=0.5 \
    --body-parts parts.json $(epochs 40)
  for model in singles sinc_pairs sinc_ste sinc sinc_synthetic; do
    measure $model trained/$model/model --data data --splits splits --babel together.json --items unseen \
      --temos trained/singles/model --body-parts parts.json --conjunction while --samples "$(full 2 10)"
  done
}

table_tm2t() {
  tm2t="train-tm2t --captions captions.tsv $small $clips_too --set tokenizer.channels=$(full '[8,8]' '[64,64]')"
  judge="train-evaluator --captions captions.tsv $small --set data.mirror=false --set optimiser.batch=$(full 4 32)"
  if [ "$quick" ]; then
    tm2t="$tm2t --set tokenizer.codes=8 --set tokenizer.discriminator=8 --set tokenizer.window=32"
    tm2t="$tm2t --set motion_to_text={\"latent_dim\":8,\"ff_size\":8,\"num_layers\":1,\"num_heads\":2}"
    tm2t="$tm2t --set text_to_motion={\"text_hidden\":8,\"motion_hidden\":8,\"word_width\":8}"
    judge="$judge --set movement={\"hidden\":8,\"latent\":8}"
    judge="$judge --set matching={\"text_hidden\":8,\"motion_hidden\":8,\"embedding\":8,\"word_width\":8}"
  fi
  from_tokens="--tokenizer trained/tokenizer/model"
  train movement $judge --stage movement $(epochs 5)
  train evaluator $judge --stage matching --movement trained/movement/model $(epochs 30)
  train tokenizer $tm2t --stage tokenizer $(epochs 6)
  train m2t $tm2t --stage motion-to-text $from_tokens $(epochs 60)
  train m2t_no_tokens $tm2t --stage motion-to-text $from_tokens --set motion_to_text.tokens=false $(epochs 60)
  train t2m $tm2t --stage text-to-motion --describer trained/m2t/model $(epochs 60)
  train t2m_no_alignment $tm2t --stage text-to-motion $from_tokens --set text_to_motion.alignment=false $(epochs 60)
  train t2m_transformer $tm2t --stage text-to-motion $from_tokens --set text_to_motion.network=transformer $(epochs 60)
  for model in m2t m2t_no_tokens; do
    measure $model trained/$model/model --data data --splits splits --captions captions.tsv --evaluator trained/evaluator/model
  done
  for model in t2m t2m_no_alignment t2m_transformer; do
    measure $model trained/$model/model --data data --splits splits --captions captions.tsv --evaluator trained/evaluator/model \
      --seeds "$(full 2 5)" --repeats 0
  done
}

# ---- the page

# row RESULT TITLE BEGIN [AFTER]: the line of results/RESULT.txt that begins so, below one that has AFTER, as a line of
# a table; "missing" if there is none.
row() {
  if [ -f "results/$1.txt" ]; then
    awk -v title="$2" -v begin="$3" -v after="${4:-}" '
      !found && index($0, after) { found = 1; if (after != "") next }
      { sub(/^ +/, "") }
      found && index($0, begin) == 1 {
        $0 = substr($0, length(begin) + 1)
        gsub(/ *[+]-/, "±")
        line = "| " title " |"
        for (i = 1; i <= NF; ++i) line = line " " $i " |"
        print line
        done = 1
        exit
      }
      END { if (!done) print "| " title " | missing |" }' "results/$1.txt"
  else
    echo "| $2 | missing |"
  fi
}

# head_of COLUMN...: the first two lines of a table.
head_of() {
  line='|' under='|'
  for column in "$@"; do line="$line $column |" under="$under --- |"; done
  printf '\n%s\n%s\n' "$line" "$under"
}

# whole RESULT: all of a result that is a table already.
whole() { if [ -f "results/$1.txt" ]; then cat "results/$1.txt"; else echo "missing"; fi; }

# sinc_rows [AFTER]: a line for each training of SINC.
sinc_rows() {
  row singles "single actions" "one sample" "${1:-}"
  row singles "single actions, composed by body parts" "labels alone, composed" "${1:-}"
  row sinc_ste "SINC-STE, pairs" "one sample" "${1:-}"
  row sinc_pairs "SINC, pairs" "one sample" "${1:-}"
  row sinc "SINC, pairs and singles" "one sample" "${1:-}"
  row sinc_synthetic "SINC, pairs, singles and synthetic pairs" "one sample" "${1:-}"
}

# figure RESULT COLUMN BEGIN [AFTER]: that value of the line that `row` finds; no number if there is none.
figure() { row "$1" . "$3" "${4:-}" | awk -F ' *[|] *' -v at="$2" '{ sub(/±.*/, "", $(at + 2)); print $(at + 2) }'; }

# stmc_figure COLUMN METHOD [JUDGE [TABLE]]: the same of table 6.1. TABLE is "as coded" or "as written".
stmc_figure() {
  judged=results/stmc_${3:-judge_of_pairs}.txt
  [ ! -f "$judged" ] || awk -F ' *[|] *' -v at="$1" -v method="$2" -v table="^${4:-as coded}" '
    $0 ~ table { found = 1 }
    found && $2 == method { print $(at + 4); exit }' "$judged"
}

# claim WHAT PAPER SIGN PAPER HERE HERE: a line of the table of orderings. SIGN is "<" or ">".
claim() {
  awk -v what="$1" -v a="$2" -v sign="$3" -v b="$4" -v x="$5" -v y="$6" 'BEGIN {
    number = "^-?[0-9]+([.][0-9]+)?$"
    here = x ~ number && y ~ number ? x " " sign " " y : "missing"
    holds = here == "missing" ? "missing" : x + 0 == y + 0 ? "equal" : (x + 0 < y + 0) == (sign == "<") ? "yes" : "no"
    print "| " what " | " a " " sign " " b " | " here " | " holds " |"
  }'
}

# The orderings that the papers conclude from these tables, and whether they are the same here.
orderings() {
  printf '\n## Orderings of the papers\n'
  head_of "figure: first row, second row" "paper" "here" "same order"
  for other in "one text:30.5 > 12.1" "DiffCollage, single track:30.5 > 29.1" \
    "SINC without lerp:30.5 < 32.3" "SINC with lerp:30.5 < 31.8"; do
    name=${other%%:*} values=${other#*:}
    for judge in judge judge_of_pairs; do
      [ $judge = judge ] && seen='judge of single clips' || seen='judge of clips and pairs'
      claim "STMC 6.1, R@1, $seen: STMC, $name" $values "$(stmc_figure 1 STMC $judge)" "$(stmc_figure 1 "$name" $judge)"
    done
  done
  for other in "one text:1.8" "DiffCollage, single track:1.2" "SINC without lerp:4.2" "SINC with lerp:1.2"; do
    name=${other%%:*}
    for table in "as coded" "as written"; do
      claim "STMC 6.1, transition $table: STMC, $name" 0.9 "<" "${other#*:}" \
        "$(stmc_figure 6 STMC judge "$table")" "$(stmc_figure 6 "$name" judge "$table")"
    done
  done
  accuracy() { figure "$1" 1 generated; }
  claim "ACTOR 3.2, accuracy: rotations and points, rotations" 91.1 ">" 42.4 "$(accuracy actor)" "$(accuracy actor_rotations)"
  claim "ACTOR 3.2, accuracy: rotations, joints" 42.4 ">" 3.3 "$(accuracy actor_rotations)" "$(accuracy actor_joints)"
  claim "ACTOR 3.4, accuracy: Transformer, GRU" 91.1 ">" 87.3 "$(accuracy actor)" "$(accuracy actor_gru)"
  claim "ACTOR 3.7, accuracy: ACTOR, a latent for each frame" 95.5 ">" 92.3 "$(accuracy actor)" "$(accuracy actor_frames)"
  claim "ACTOR 3.7, FID: ACTOR, a latent for each frame" 0.12 "<" 2.46 "$(figure actor 2 generated)" "$(figure actor_frames 2 generated)"
  root() { figure "$1" 1 "one sample"; }
  for other in "deterministic:temos_deterministic:1.175" "deterministic, GRUs (JL2P in the paper):temos_jl2p:1.622" \
    "deterministic, GRU decoder (Lin et al. in the paper):temos_lin:1.966" \
    "GRU:temos_gru:1.443" "without motion encoder:temos_no_encoder:1.178" "without embedding loss:temos_no_embedding:1.091" \
    "without cross-modal KL:temos_no_cross:0.993" "without Gaussian priors:temos_no_priors:1.049"; do
    name=${other%%:*} rest=${other#*:}
    claim "TEMOS 4.1 to 4.3, APE root: TEMOS, $name" 0.963 "<" "${rest#*:}" "$(root temos)" "$(root "${rest%%:*}")"
  done
  claim "TEMOS 4.2, APE root: best of ten, one sample" 0.784 "<" 0.963 "$(figure temos 1 "best of $(full 2 10) samples")" "$(root temos)"
  recall() { figure "$1" 1 "all, texts alike"; }
  for other in "not filtered:tmr_unfiltered:22.17" "without reconstruction:tmr_no_motions:19.76" "margin:tmr_margin:19.88" \
    "no contrast:tmr_temos:18.55"; do
    name=${other%%:*} rest=${other#*:}
    claim "TMR 5.3, 5.4, R@1: TMR (threshold 0.8; here 0.88), $name" 24.58 ">" "${rest#*:}" "$(recall tmr)" "$(recall "${rest%%:*}")"
  done
  claim "TEACH A.1, APE root: TEACH, independent" 0.674 "<" 0.729 "$(root teach)" "$(figure teach 1 "independent  ")"
  claim "TEACH A.1, APE root: independent, joint" 0.729 "<" 0.790 "$(figure teach 1 "independent  ")" "$(figure teach 1 "joint  ")"
  claim "TEACH A.2, transition: TEACH, independent" 0.107 "<" 0.151 \
    "$(figure teach 1 "turned and moved" "transition distance")" \
    "$(figure teach 1 "independent, turned and moved" "transition distance")"
  score() { figure "$1" 1 "${2:-one sample}" "TEMOS score"; }
  claim "SINC B.2, score: composed by body parts, single actions" 0.618 ">" 0.601 \
    "$(score singles "labels alone, composed")" "$(score singles)"
  claim "SINC B.2, score: SINC, SINC-STE" 0.631 ">" 0.614 "$(score sinc_pairs)" "$(score sinc_ste)"
  claim "SINC B.2, score: pairs and singles, pairs" 0.640 ">" 0.631 "$(score sinc)" "$(score sinc_pairs)"
  claim "SINC B.2, score: pairs and singles, composed by body parts" 0.640 ">" 0.618 \
    "$(score sinc)" "$(score singles "labels alone, composed")"
  claim "SINC B.3, score: half synthetic pairs, none" 0.644 ">" 0.640 "$(score sinc_synthetic)" "$(score sinc)"
  claim "TM2T 1, R@1: TM2T, without motion tokens" 0.516 ">" 0.483 "$(figure m2t 1 described)" "$(figure m2t_no_tokens 1 described)"
  claim "TM2T 1, CIDEr: TM2T, without motion tokens" 72.5 ">" 68.3 "$(figure m2t 10 described)" "$(figure m2t_no_tokens 10 described)"
  for other in "without inverse alignment:t2m_no_alignment:1.739" "Transformer:t2m_transformer:1.669"; do
    name=${other%%:*} rest=${other#*:}
    claim "TM2T 2, R@1: TM2T, $name" 0.424 ">" 0.351 "$(figure t2m 1 generated)" "$(figure "${rest%%:*}" 1 generated)"
    claim "TM2T 2, FID: TM2T, $name" 1.501 "<" "${rest#*:}" "$(figure t2m 4 generated)" "$(figure "${rest%%:*}" 4 generated)"
  done
}

errors() { head_of "$1" "APE root" traj. local global "AVE root" traj. local global; }

page() {
  echo "# The systems of the papers on $(grep -vc '^#' labels.tsv) clips of the Bandai-Namco Research Motiondataset"
  echo
  in_part() { grep -c '^dataset' "splits/$1.txt"; }
  echo "Clips: $(in_part train) to train with, $(in_part val) for validation, $(in_part test) for tests."
  [ ! "$quick" ] || echo "A quick trial: these figures mean nothing."
  for judge in judge judge_of_pairs; do
    [ $judge = judge ] && seen='the single clips' || seen='single clips and composed pairs'
    printf '\n## STMC, table 6.1, judged by a TMR of %s\n\n' "$seen"
    whole stmc_$judge
  done
  printf '\n## STMC, table 6.2\n\n'
  whole overlap
  printf '\n## ACTOR, table 3.2\n'
  head_of losses "accuracy %" FID diversity multimodality
  row actor recorded "recorded "
  row actor_joints "joints" generated
  row actor_rotations "rotations" generated
  row actor "rotations and joints" generated
  printf '\n## ACTOR, tables 3.4 and 3.7\n'
  head_of network "accuracy %" FID diversity multimodality
  row actor "Transformer" generated
  row actor_gru "GRU, a latent for each motion" generated
  row actor_frames "GRU, a latent for each frame (as Action2Motion)" generated
  printf '\n## TEMOS, tables 4.1 and 4.2\n'
  errors motions
  samples="$(full 2 10) samples"
  for line in "one sample" "mean of $samples" "best of $samples" "worst of $samples" "mean of the latent" "mean pose" \
    "random clip"; do
    row temos "$line" "$line"
  done
  row temos_deterministic "deterministic" "one sample"
  row temos_jl2p "deterministic, GRUs (in place of JL2P)" "one sample"
  row temos_lin "deterministic, GRU, without motion encoder (in place of Lin et al.)" "one sample"
  printf '\n## TEMOS, table 4.3, one sample\n'
  errors network
  row temos TEMOS "one sample"
  row temos_gru GRU "one sample"
  row temos_no_encoder "without motion encoder" "one sample"
  row temos_no_embedding "without embedding loss" "one sample"
  row temos_no_cross "without cross-modal KL" "one sample"
  row temos_no_priors "without Gaussian priors" "one sample"
  printf '\n## TMR, tables 5.1, 5.3, 5.4: text to motion, then motion to text\n'
  head_of training R@1 R@2 R@3 R@5 R@10 MedR R@1 R@2 R@3 R@5 R@10 MedR
  row tmr "InfoNCE, filtered" "all, texts alike"
  row tmr_unfiltered "InfoNCE, not filtered" "all, texts alike"
  row tmr_no_motions "InfoNCE without reconstruction" "all, texts alike"
  row tmr_margin "margin" "all, texts alike"
  row tmr_temos "no contrast (TEMOS)" "all, texts alike"
  row tmr "by chance" "by chance" "all, texts alike"
  printf '\n## TEACH, table A.1\n'
  errors motions
  row teach TEACH "one sample"
  for line in independent joint "mean pose" "random clip"; do row teach "$line" "$line  "; done
  printf '\n## TEACH, table A.2\n'
  head_of motions "transition distance (m)"
  for line in "turned and moved" "moved" "independent, turned and moved" "independent, moved" "joint" "recorded"; do
    row teach "$line" "$line" "transition distance"
  done
  printf '\n## SINC, table B.2, unseen pairs\n'
  errors training
  sinc_rows
  row sinc "mean pose" "mean pose"
  row sinc "random clip" "random clip"
  head_of training "TEMOS score"
  sinc_rows "TEMOS score"
  row sinc "another recorded one" "another recorded one" "TEMOS score"
  printf '\n## TM2T, table 1\n'
  head_of descriptions R@1 R@2 R@3 MM-Dist BLEU-1 BLEU-2 BLEU-3 BLEU-4 ROUGE-L CIDEr
  row m2t "of people" "the first text of people"
  row m2t "TM2T" "described"
  row m2t_no_tokens "without motion tokens" "described"
  row m2t "random" "a random text of the training part"
  printf '\n## TM2T, table 2\n'
  head_of motions R@1 R@2 R@3 FID MM-Dist diversity multimodality
  row t2m recorded "recorded "
  row t2m TM2T generated
  row t2m_no_alignment "without inverse alignment" generated
  row t2m_transformer "Transformer (T)" generated
  orderings
  printf '\n## Processor time of each training\n'
  head_of training seconds
  for file in trained/*/times; do
    [ ! -f "$file" ] || awk -v name="$(basename "$(dirname "$file")")" '
      FNR % 2 == 0 { for (i = 1; i <= 2; ++i) { split($i, t, "m"); sum += 60 * t[1] + t[2] } }
      END { printf "| %s | %.0f |\n", name, sum }' "$file"
  done
}

once tables make_tables
for chapter in $chapters; do
  "table_$chapter"
  page > page.md
done
page > page.md
echo "$out/page.md"
