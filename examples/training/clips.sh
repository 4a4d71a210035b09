#!/bin/sh
# Lays the free clips that captions.tsv names into one folder.
#
#     examples/training/clips.sh FREE CLIPS [MOTIONLANG]
#
# FREE holds the archives free-*.tar.xz and the folders kaykit and mesh2motion. MOTIONLANG is the program; the default is
# the one in PATH. The figures of Animated Drawings stand along Z and their unit is 3.5 or 5 cm, so they are converted.
set -e
free=$1 clips=$2 program=${3:-motionlang}
[ -d "$free" ] && [ -n "$clips" ] || { echo "usage: clips.sh FREE CLIPS [MOTIONLANG]" >&2; exit 2; }
mkdir -p "$clips"
for name in cmu-daz cmu-motionbuilder cmu-asf-amc reactidle kaykit-animations animated-drawings; do
  tar -xJf "$free/free-$name.tar.xz" -C "$clips"
done
cp -R "$free/kaykit" "$free/mesh2motion" "$clips"
chmod -R u+w "$clips"
drawings=$clips/animated-drawings
for name in dab jumping wave_hello zombie; do
  "$program" convert "$drawings/$name.bvh" "$drawings/upright.bvh" --up z --scale 0.035
  mv "$drawings/upright.bvh" "$drawings/$name.bvh"
done
# Poser's names, and arms that hang without rotations
for row in pelvis:Hips spine1:lowerback spine2:Chest spine3:Chest2 neck:Neck head:Head \
  left_hip:LeftHip left_knee:LeftKnee left_ankle:LeftAnkle left_foot:LeftToe \
  right_hip:RightHip right_knee:RightKnee right_ankle:RightAnkle right_foot:RightToe \
  left_shoulder:LeftShoulder:-y+x left_elbow:LeftElbow:-y+x left_wrist:LeftWrist:-y+x \
  right_shoulder:RightShoulder:+y-x right_elbow:RightElbow:+y-x right_wrist:RightWrist:+y-x; do
  echo "$row" | tr ':' '\t'
done > "$drawings/joints.tsv"
"$program" convert "$drawings/jumping_jacks.bvh" "$drawings/upright.bvh" --joints "$drawings/joints.tsv" --scale 0.05
mv "$drawings/upright.bvh" "$drawings/jumping_jacks.bvh"
# Lying down on the back, and getting up: sitting down on the floor and lying are joined
part=$clips/part
mkdir -p "$part" "$clips/joined"
"$program" convert "$clips/kaykit-animations/Rig_Medium_Simulation.glb" "$part/a.npz"
"$program" convert "$clips/mesh2motion/8332a1e.glb" "$part/a.npz"
"$program" convert "$part/a_Sit_Floor_Down.npz" "$part/down.npz" --speed 0.6
"$program" convert "$part/a_Sit_Floor_StandUp.npz" "$part/up.npz" --speed 0.75
"$program" join "$part/down.npz" "$part/a_Sleeping.npz" --blend 1.1 --output "$clips/joined/lie_down.npz"
"$program" join "$part/a_Sleeping.npz" "$part/up.npz" --blend 1 --output "$clips/joined/get_up.npz"
rm -r "$part"
# Gestures by hand over people who stand still; needs Python 3 with NumPy
k=0
set --
for window in reactidle/001_acted:0.2:7 reactidle/002_genuine:46:53 reactidle/002_genuine:54:62.5 \
  cmu-motionbuilder/05_18:4.8:9.4; do
  from=${window#*:}
  "$program" convert "$clips/${window%%:*}.bvh" "$clips/standing_$k.npz" --from "${from%:*}" --to "${from#*:}" --fps 20
  set -- "$@" "$clips/standing_$k.npz"
  k=$((k + 1))
done
python3 "$(dirname "$0")/gestures" "$@" "$clips/gestures"
rm "$@"
