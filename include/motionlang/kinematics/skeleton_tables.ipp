// SPDX-License-Identifier: MIT
// Bodies of skeleton_tables.hpp.
#pragma once

#include <utility>  // pair

#include <motionlang/kinematics/skeleton_tables.hpp>
#include <motionlang/kinematics/standing_skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A built-in table as a constant. As strings and vectors the tables would be a function of 130 kB.
struct KnownTable {
  struct Joint {
    std::string_view target, source, axes = "+x+y";
    Vec3<double> turn{};
    std::string_view second{};
    double share = 0;
  };
  std::string_view name;
  Joint joints[24];  // as many as SMPL has; those that are not given have no target
  bool straighten = true, level_soles = false;

  operator SkeletonTable() const {
    SkeletonTable table{.name = std::string(name), .joints = {}, .straighten = straighten, .level_soles = level_soles};
    for (const Joint& j : joints) {
      if (j.target.empty()) break;
      table.joints.push_back(
          {std::string(j.target), std::string(j.source), std::string(j.axes), j.turn, std::string(j.second), j.share});
    }
    return table;
  }
};

// clang-format off
// Shares of the spine follow from the heights of the joints between hips and neck.
inline constexpr KnownTable known_tables[] = {
    {"SMPL",
     {{"pelvis", "pelvis"}, {"spine1", "spine1"}, {"spine2", "spine2"}, {"spine3", "spine3"}, {"neck", "neck"}, {"head", "head"},
      {"left_hip", "left_hip"}, {"left_knee", "left_knee"}, {"left_ankle", "left_ankle"}, {"left_foot", "left_foot"},
      {"right_hip", "right_hip"}, {"right_knee", "right_knee"}, {"right_ankle", "right_ankle"}, {"right_foot", "right_foot"},
      {"left_collar", "left_collar"}, {"left_shoulder", "left_shoulder"}, {"left_elbow", "left_elbow"}, {"left_wrist", "left_wrist"}, {"left_hand", "left_hand"},
      {"right_collar", "right_collar"}, {"right_shoulder", "right_shoulder"}, {"right_elbow", "right_elbow"}, {"right_wrist", "right_wrist"}, {"right_hand", "right_hand"}}},
    // Made from the MotionBuilder files. The turns were measured on the 58 trials that exist as both.
    {"CMU Daz",
     {{"pelvis", "hip"}, {"spine1", "hip", "+x+y", {}, "abdomen", 0.74}, {"spine2", "abdomen", "+x+y", {}, "chest", 0.5}, {"spine3", "chest"},
      {"neck", "neck", "+x+y", {6, 0, 0}}, {"head", "head", "+x+y", {-16, 0, 0}},
      {"left_hip", "lThigh", "+x+y", {-4.7, 0, 0}}, {"left_knee", "lShin", "+x+y", {-4.2, 0, 0}}, {"left_ankle", "lFoot"},
      {"right_hip", "rThigh", "+x+y", {-4.7, 0, 0}}, {"right_knee", "rShin", "+x+y", {-4.2, 0, 0}}, {"right_ankle", "rFoot"},
      {"left_collar", "lCollar"}, {"left_shoulder", "lShldr", "+x+y", {0, 0, 8}}, {"left_elbow", "lForeArm", "+x+y", {0, 0, 8}}, {"left_wrist", "lHand", "+x+y", {0, 0, 8}}, {"left_hand", "lMid1"},
      {"right_collar", "rCollar"}, {"right_shoulder", "rShldr", "+x+y", {0, 0, -8}}, {"right_elbow", "rForeArm", "+x+y", {0, 0, -8}}, {"right_wrist", "rHand", "+x+y", {0, 0, -8}}, {"right_hand", "rMid1"}},
     false},
    {"CMU MotionBuilder",
     {{"pelvis", "Hips"}, {"spine1", "LowerBack"}, {"spine2", "Spine"}, {"spine3", "Spine1"}, {"neck", "Neck", "+x+y", {}, "Neck1", 0.5}, {"head", "Head"},
      {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
      {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
      {"left_collar", "LeftShoulder"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftFingerBase"}, {"left_hand", "LeftHandIndex1"},
      {"right_collar", "RightShoulder"}, {"right_shoulder", "RightArm"}, {"right_elbow", "RightForeArm"}, {"right_wrist", "RightFingerBase"}, {"right_hand", "RightHandIndex1"}}},
    {"CMU ASF",
     {{"pelvis", "root"}, {"spine1", "lowerback"}, {"spine2", "upperback"}, {"spine3", "thorax"}, {"neck", "lowerneck", "+x+y", {}, "upperneck", 0.5}, {"head", "head"},
      {"left_hip", "lfemur"}, {"left_knee", "ltibia"}, {"left_ankle", "lfoot"}, {"left_foot", "ltoes"},
      {"right_hip", "rfemur"}, {"right_knee", "rtibia"}, {"right_ankle", "rfoot"}, {"right_foot", "rtoes"},
      {"left_collar", "lclavicle"}, {"left_shoulder", "lhumerus"}, {"left_elbow", "lradius"}, {"left_wrist", "lhand"}, {"left_hand", "lfingers"},
      {"right_collar", "rclavicle"}, {"right_shoulder", "rhumerus"}, {"right_elbow", "rradius"}, {"right_wrist", "rhand"}, {"right_hand", "rfingers"}}},
    // Local axes of Maya's kind: x runs along the bone (on the right side against it), nothing is zero in a T-pose.
    {"Bandai-Namco",
     {{"pelvis", "Hips", "-y+x"}, {"spine1", "Hips", "-y+x", {}, "Spine", 0.48}, {"spine2", "Spine", "+z+x"}, {"spine3", "Chest", "+z+x"}, {"neck", "Neck", "+z+x"}, {"head", "Head", "+z+x"},
      {"left_hip", "UpperLeg_L", "+y-x"}, {"left_knee", "LowerLeg_L", "+y-x"}, {"left_ankle", "Foot_L", "+y+z", {39.5, 0, 0}}, {"left_foot", "Toes_L", "+y+z", {21, 0, 0}},
      {"right_hip", "UpperLeg_R", "+y+x"}, {"right_knee", "LowerLeg_R", "+y+x"}, {"right_ankle", "Foot_R", "+y-z", {39.5, 0, 0}}, {"right_foot", "Toes_R", "+y-z", {21, 0, 0}},
      {"left_collar", "Shoulder_L", "+x+y"}, {"left_shoulder", "UpperArm_L", "+x+y"}, {"left_elbow", "LowerArm_L", "+x+y"}, {"left_wrist", "Hand_L", "+x+y"},
      {"right_collar", "Shoulder_R", "+x-y"}, {"right_shoulder", "UpperArm_R", "+x-y"}, {"right_elbow", "LowerArm_R", "+x-y"}, {"right_wrist", "Hand_R", "+x-y"}}},
    {"ReactIdle",
     {{"pelvis", "pelvis"}, {"spine1", "spine"}, {"spine2", "spine", "+x+y", {}, "spine.001", 0.5}, {"spine3", "spine.001"}, {"neck", "neck"}, {"head", "face"},
      {"left_hip", "thigh.L"}, {"left_knee", "shin.L"}, {"left_ankle", "foot.L"},
      {"right_hip", "thigh.R"}, {"right_knee", "shin.R"}, {"right_ankle", "foot.R"},
      {"left_collar", "shoulder.L"}, {"left_shoulder", "upper_arm.L"}, {"left_elbow", "forearm.L"},
      {"right_collar", "shoulder.R"}, {"right_shoulder", "upper_arm.R"}, {"right_elbow", "forearm.R"}}},
    {"ACCAD",
     {{"pelvis", "Hips", "-z+x"}, {"spine1", "ToSpine"}, {"spine2", "Spine", "+z+x"}, {"spine3", "Spine1", "+z+x"}, {"neck", "Neck", "-z+x"}, {"head", "Head", "-y+x"},
      {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
      {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
      {"left_collar", "LeftShoulder", "+z+x"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftHand"},
      {"right_collar", "RightShoulder", "+z+x"}, {"right_shoulder", "RightArm", "-x+y"}, {"right_elbow", "RightForeArm", "-x+y"}, {"right_wrist", "RightHand", "-x+y"}}},
    // The figure of the first BVH files: upright, but with hanging arms when all rotations are zero.
    {"Biovision",
     {{"pelvis", "Hips"}, {"spine1", "Hips", "+x+y", {}, "Chest", 0.5}, {"spine2", "Chest"}, {"spine3", "Chest"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLowLeg"}, {"left_ankle", "LeftFoot"},
      {"right_hip", "RightUpLeg"}, {"right_knee", "RightLowLeg"}, {"right_ankle", "RightFoot"},
      {"left_collar", "LeftCollar"}, {"left_shoulder", "LeftUpArm", "-y+x"}, {"left_elbow", "LeftLowArm", "-y+x"}, {"left_wrist", "LeftHand", "-y+x"},
      {"right_collar", "RightCollar"}, {"right_shoulder", "RightUpArm", "+y-x"}, {"right_elbow", "RightLowArm", "+y-x"}, {"right_wrist", "RightHand", "+y-x"}}},
    // SMPL's joints as its add-ons for Blender and engines write them.
    {"SMPL add-on",
     {{"pelvis", "Pelvis"}, {"spine1", "Spine1"}, {"spine2", "Spine2"}, {"spine3", "Spine3"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "L_Hip"}, {"left_knee", "L_Knee"}, {"left_ankle", "L_Ankle"}, {"left_foot", "L_Foot"},
      {"right_hip", "R_Hip"}, {"right_knee", "R_Knee"}, {"right_ankle", "R_Ankle"}, {"right_foot", "R_Foot"},
      {"left_collar", "L_Collar"}, {"left_shoulder", "L_Shoulder"}, {"left_elbow", "L_Elbow"}, {"left_wrist", "L_Wrist"}, {"left_hand", "L_Hand"},
      {"right_collar", "R_Collar"}, {"right_shoulder", "R_Shoulder"}, {"right_elbow", "R_Elbow"}, {"right_wrist", "R_Wrist"}, {"right_hand", "R_Hand"}},
     true, true},
    // Noitom's suits (Axis Neuron): a T-pose without rotations, four joints in the spine, no toes.
    {"Noitom",
     {{"pelvis", "Hips"}, {"spine1", "Spine"}, {"spine2", "Spine1", "+x+y", {}, "Spine2", 0.5}, {"spine3", "Spine3"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
      {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
      {"left_collar", "LeftShoulder"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftHand"}, {"left_hand", "LeftHandMiddle1"},
      {"right_collar", "RightShoulder"}, {"right_shoulder", "RightArm"}, {"right_elbow", "RightForeArm"}, {"right_wrist", "RightHand"}, {"right_hand", "RightHandMiddle1"}}},
    // Rigs of game characters: as GLB files hold them, rest rotations are taken out, so that all axes are "+x+y".
    {"Mixamo",
     {{"pelvis", "Hips"}, {"spine1", "Spine"}, {"spine2", "Spine1"}, {"spine3", "Spine2"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
      {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
      {"left_collar", "LeftShoulder"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftHand"}, {"left_hand", "LeftHandMiddle1"},
      {"right_collar", "RightShoulder"}, {"right_shoulder", "RightArm"}, {"right_elbow", "RightForeArm"}, {"right_wrist", "RightHand"}, {"right_hand", "RightHandMiddle1"}},
     true, true},
    // Ubisoft's LaFAN1 has Mixamo's names, but in its zero pose all bones lie along x. In a T-pose x runs along the
    // bone and y to the front (for feet up); z mirrors the sides. Offsets show this for the trunk. Limbs are assumed to
    // be alike, which was not compared with recordings. Feet are turned by the slope of SMPL's.
    {"LaFAN1",
     {{"pelvis", "Hips", "+z+x"}, {"spine1", "Spine", "+z+x"}, {"spine2", "Spine1", "+z+x"}, {"spine3", "Spine2", "+z+x"}, {"neck", "Neck", "+z+x"}, {"head", "Head", "+z+x"},
      {"left_hip", "LeftUpLeg", "-z-x"}, {"left_knee", "LeftLeg", "-z-x"}, {"left_ankle", "LeftFoot", "-z+y", {23, 0, 0}}, {"left_foot", "LeftToe", "-z+y"},
      {"right_hip", "RightUpLeg", "-z-x"}, {"right_knee", "RightLeg", "-z-x"}, {"right_ankle", "RightFoot", "-z+y", {23, 0, 0}}, {"right_foot", "RightToe", "-z+y"},
      {"left_collar", "LeftShoulder", "+x-z"}, {"left_shoulder", "LeftArm", "+x-z"}, {"left_elbow", "LeftForeArm", "+x-z"}, {"left_wrist", "LeftHand", "+x-z"},
      {"right_collar", "RightShoulder", "-x+z"}, {"right_shoulder", "RightArm", "-x+z"}, {"right_elbow", "RightForeArm", "-x+z"}, {"right_wrist", "RightHand", "-x+z"}}},
    // Xsens' suits, and 100STYLE, recorded with one. Chest is their L5, Chest2 L3, Chest3 T12 and Chest4 T8.
    {"Xsens",
     {{"pelvis", "Hips"}, {"spine1", "Chest"}, {"spine2", "Chest2", "+x+y", {}, "Chest3", 0.5}, {"spine3", "Chest4"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "LeftHip"}, {"left_knee", "LeftKnee"}, {"left_ankle", "LeftAnkle"}, {"left_foot", "LeftToe"},
      {"right_hip", "RightHip"}, {"right_knee", "RightKnee"}, {"right_ankle", "RightAnkle"}, {"right_foot", "RightToe"},
      {"left_collar", "LeftCollar"}, {"left_shoulder", "LeftShoulder"}, {"left_elbow", "LeftElbow"}, {"left_wrist", "LeftWrist"},
      {"right_collar", "RightCollar"}, {"right_shoulder", "RightShoulder"}, {"right_elbow", "RightElbow"}, {"right_wrist", "RightWrist"}}},
    // Rokoko's suits, with the names of Studio's own skeleton ("Newton").
    {"Rokoko",
     {{"pelvis", "Hips"}, {"spine1", "Spine1"}, {"spine2", "Spine2", "+x+y", {}, "Spine3", 0.5}, {"spine3", "Spine4"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "LeftThigh"}, {"left_knee", "LeftShin"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToe"},
      {"right_hip", "RightThigh"}, {"right_knee", "RightShin"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToe"},
      {"left_collar", "LeftShoulder"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftHand"}, {"left_hand", "LeftFinger3Proximal"},
      {"right_collar", "RightShoulder"}, {"right_shoulder", "RightArm"}, {"right_elbow", "RightForeArm"}, {"right_wrist", "RightHand"}, {"right_hand", "RightFinger3Proximal"}}},
    // SOMA, the skeleton of Kimodo and BONES-SEED: LeftLeg is the thigh. Bones lie along x without rotations; axes and turns
    // are those of its T-pose.
    {"SOMA",
     {{"pelvis", "Hips", "+z+x"}, {"spine1", "Spine1", "+z+x"}, {"spine2", "Spine2", "+z+x", {-6, 0, 0}}, {"spine3", "Chest", "+z+x"},
      {"neck", "Neck1", "+z+x", {17, 0, 0}}, {"head", "Head", "+z+x", {-7, 0, 0}},
      {"left_hip", "LeftLeg", "+z-x", {1, 0, 0}}, {"left_knee", "LeftShin", "+z-x", {5, 0, 0}}, {"left_ankle", "LeftFoot", "+z-y", {21, 0, 0}}, {"left_foot", "LeftToeBase", "+z-y", {16, 0, 0}},
      {"right_hip", "RightLeg", "+z+x", {1, 0, 0}}, {"right_knee", "RightShin", "+z+x", {5, 0, 0}}, {"right_ankle", "RightFoot", "+z+y", {21, 0, 0}}, {"right_foot", "RightToeBase", "+z+y", {16, 0, 0}},
      {"left_collar", "LeftShoulder", "+x-z", {0, 20, 0}}, {"left_shoulder", "LeftArm", "+x-z"}, {"left_elbow", "LeftForeArm", "+x-z"}, {"left_wrist", "LeftHand", "+x-z", {10, 0, 0}}, {"left_hand", "LeftHandMiddle1", "+x-z", {10, 0, 0}},
      {"right_collar", "RightShoulder", "+x+z", {0, -20, 0}}, {"right_shoulder", "RightArm", "+x+z"}, {"right_elbow", "RightForeArm", "+x+z"}, {"right_wrist", "RightHand", "+x+z", {10, 0, 0}}, {"right_hand", "RightHandMiddle1", "+x+z", {10, 0, 0}}}},
    {"KayKit",
     {{"pelvis", "hips"}, {"spine1", "spine"}, {"spine2", "spine", "+x+y", {}, "chest", 0.5}, {"spine3", "chest"}, {"neck", "chest", "+x+y", {}, "head", 0.5}, {"head", "head"},
      {"left_hip", "upperleg.l"}, {"left_knee", "lowerleg.l"}, {"left_ankle", "foot.l"}, {"left_foot", "toes.l"},
      {"right_hip", "upperleg.r"}, {"right_knee", "lowerleg.r"}, {"right_ankle", "foot.r"}, {"right_foot", "toes.r"},
      {"left_shoulder", "upperarm.l"}, {"left_elbow", "lowerarm.l"}, {"left_wrist", "wrist.l"}, {"left_hand", "hand.l"},
      {"right_shoulder", "upperarm.r"}, {"right_elbow", "lowerarm.r"}, {"right_wrist", "wrist.r"}, {"right_hand", "hand.r"}},
     true, true},
    {"Quaternius",
     {{"pelvis", "DEF-hips"}, {"spine1", "DEF-spine.001"}, {"spine2", "DEF-spine.002"}, {"spine3", "DEF-spine.003"}, {"neck", "DEF-neck"}, {"head", "DEF-head"},
      {"left_hip", "DEF-thigh.L"}, {"left_knee", "DEF-shin.L"}, {"left_ankle", "DEF-foot.L"}, {"left_foot", "DEF-toe.L"},
      {"right_hip", "DEF-thigh.R"}, {"right_knee", "DEF-shin.R"}, {"right_ankle", "DEF-foot.R"}, {"right_foot", "DEF-toe.R"},
      {"left_collar", "DEF-shoulder.L"}, {"left_shoulder", "DEF-upper_arm.L"}, {"left_elbow", "DEF-forearm.L"}, {"left_wrist", "DEF-hand.L"}, {"left_hand", "DEF-f_middle.01.L"},
      {"right_collar", "DEF-shoulder.R"}, {"right_shoulder", "DEF-upper_arm.R"}, {"right_elbow", "DEF-forearm.R"}, {"right_wrist", "DEF-hand.R"}, {"right_hand", "DEF-f_middle.01.R"}},
     true, true},
    // The mannequins; the fourth has three joints in the spine and one in the neck.
    {"Unreal 5",
     {{"pelvis", "pelvis"}, {"spine1", "spine_01"}, {"spine2", "spine_03"}, {"spine3", "spine_05"}, {"neck", "neck_01", "+x+y", {}, "neck_02", 0.5}, {"head", "head"},
      {"left_hip", "thigh_l"}, {"left_knee", "calf_l"}, {"left_ankle", "foot_l"}, {"left_foot", "ball_l"},
      {"right_hip", "thigh_r"}, {"right_knee", "calf_r"}, {"right_ankle", "foot_r"}, {"right_foot", "ball_r"},
      {"left_collar", "clavicle_l"}, {"left_shoulder", "upperarm_l"}, {"left_elbow", "lowerarm_l"}, {"left_wrist", "hand_l"}, {"left_hand", "middle_01_l"},
      {"right_collar", "clavicle_r"}, {"right_shoulder", "upperarm_r"}, {"right_elbow", "lowerarm_r"}, {"right_wrist", "hand_r"}, {"right_hand", "middle_01_r"}},
     true, true},
    {"Unreal 4",
     {{"pelvis", "pelvis"}, {"spine1", "spine_01"}, {"spine2", "spine_02"}, {"spine3", "spine_03"}, {"neck", "neck_01"}, {"head", "head"},
      {"left_hip", "thigh_l"}, {"left_knee", "calf_l"}, {"left_ankle", "foot_l"}, {"left_foot", "ball_l"},
      {"right_hip", "thigh_r"}, {"right_knee", "calf_r"}, {"right_ankle", "foot_r"}, {"right_foot", "ball_r"},
      {"left_collar", "clavicle_l"}, {"left_shoulder", "upperarm_l"}, {"left_elbow", "lowerarm_l"}, {"left_wrist", "hand_l"}, {"left_hand", "middle_01_l"},
      {"right_collar", "clavicle_r"}, {"right_shoulder", "upperarm_r"}, {"right_elbow", "lowerarm_r"}, {"right_wrist", "hand_r"}, {"right_hand", "middle_01_r"}},
     true, true},
    // The humanoid bones of VRM, of which chest and neck may be missing. Files name their joints as they like and say
    // which bone each is; VRoid's names are below.
    {"VRM",
     {{"pelvis", "hips"}, {"spine1", "spine"}, {"spine2", "chest"}, {"spine3", "upperChest"}, {"neck", "neck"}, {"head", "head"},
      {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
      {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
      {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
      {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
     true, true},
    {"VRM without upper chest",
     {{"pelvis", "hips"}, {"spine1", "spine"}, {"spine2", "spine", "+x+y", {}, "chest", 0.5}, {"spine3", "chest"}, {"neck", "neck"}, {"head", "head"},
      {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
      {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
      {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
      {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
     true, true},
    {"VRM without chest",
     {{"pelvis", "hips"}, {"spine1", "hips", "+x+y", {}, "spine", 0.5}, {"spine2", "spine"}, {"spine3", "spine"}, {"neck", "neck"}, {"head", "head"},
      {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
      {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
      {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
      {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
     true, true},
    {"VRM without neck",
     {{"pelvis", "hips"}, {"spine1", "spine"}, {"spine2", "spine", "+x+y", {}, "chest", 0.5}, {"spine3", "chest"}, {"neck", "chest", "+x+y", {}, "head", 0.5}, {"head", "head"},
      {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
      {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
      {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
      {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
     true, true},
    {"VRM without chest and neck",
     {{"pelvis", "hips"}, {"spine1", "hips", "+x+y", {}, "spine", 0.5}, {"spine2", "spine"}, {"spine3", "spine"}, {"neck", "spine", "+x+y", {}, "head", 0.5}, {"head", "head"},
      {"left_hip", "leftUpperLeg"}, {"left_knee", "leftLowerLeg"}, {"left_ankle", "leftFoot"}, {"left_foot", "leftToes"},
      {"right_hip", "rightUpperLeg"}, {"right_knee", "rightLowerLeg"}, {"right_ankle", "rightFoot"}, {"right_foot", "rightToes"},
      {"left_collar", "leftShoulder"}, {"left_shoulder", "leftUpperArm"}, {"left_elbow", "leftLowerArm"}, {"left_wrist", "leftHand"}, {"left_hand", "leftMiddleProximal"},
      {"right_collar", "rightShoulder"}, {"right_shoulder", "rightUpperArm"}, {"right_elbow", "rightLowerArm"}, {"right_wrist", "rightHand"}, {"right_hand", "rightMiddleProximal"}},
     true, true},
    {"VRoid",
     {{"pelvis", "J_Bip_C_Hips"}, {"spine1", "J_Bip_C_Spine"}, {"spine2", "J_Bip_C_Chest"}, {"spine3", "J_Bip_C_UpperChest"}, {"neck", "J_Bip_C_Neck"}, {"head", "J_Bip_C_Head"},
      {"left_hip", "J_Bip_L_UpperLeg"}, {"left_knee", "J_Bip_L_LowerLeg"}, {"left_ankle", "J_Bip_L_Foot"}, {"left_foot", "J_Bip_L_ToeBase"},
      {"right_hip", "J_Bip_R_UpperLeg"}, {"right_knee", "J_Bip_R_LowerLeg"}, {"right_ankle", "J_Bip_R_Foot"}, {"right_foot", "J_Bip_R_ToeBase"},
      {"left_collar", "J_Bip_L_Shoulder"}, {"left_shoulder", "J_Bip_L_UpperArm"}, {"left_elbow", "J_Bip_L_LowerArm"}, {"left_wrist", "J_Bip_L_Hand"}, {"left_hand", "J_Bip_L_Middle1"},
      {"right_collar", "J_Bip_R_Shoulder"}, {"right_shoulder", "J_Bip_R_UpperArm"}, {"right_elbow", "J_Bip_R_LowerArm"}, {"right_wrist", "J_Bip_R_Hand"}, {"right_hand", "J_Bip_R_Middle1"}},
     true, true},
    // Bipeds of 3ds Max and of games, whose names all begin with "Bip01 ", "Bip001_" or "ValveBiped.Bip01_".
    {"Biped",
     {{"pelvis", "Pelvis"}, {"spine1", "Spine"}, {"spine2", "Spine1"}, {"spine3", "Spine2"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "L Thigh"}, {"left_knee", "L Calf"}, {"left_ankle", "L Foot"}, {"left_foot", "L Toe0"},
      {"right_hip", "R Thigh"}, {"right_knee", "R Calf"}, {"right_ankle", "R Foot"}, {"right_foot", "R Toe0"},
      {"left_collar", "L Clavicle"}, {"left_shoulder", "L UpperArm"}, {"left_elbow", "L Forearm"}, {"left_wrist", "L Hand"}, {"left_hand", "L Finger2"},
      {"right_collar", "R Clavicle"}, {"right_shoulder", "R UpperArm"}, {"right_elbow", "R Forearm"}, {"right_wrist", "R Hand"}, {"right_hand", "R Finger2"}},
     true, true},
    {"Biped with two links in the spine",
     {{"pelvis", "Pelvis"}, {"spine1", "Spine"}, {"spine2", "Spine", "+x+y", {}, "Spine1", 0.5}, {"spine3", "Spine1"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "L Thigh"}, {"left_knee", "L Calf"}, {"left_ankle", "L Foot"}, {"left_foot", "L Toe0"},
      {"right_hip", "R Thigh"}, {"right_knee", "R Calf"}, {"right_ankle", "R Foot"}, {"right_foot", "R Toe0"},
      {"left_collar", "L Clavicle"}, {"left_shoulder", "L UpperArm"}, {"left_elbow", "L Forearm"}, {"left_wrist", "L Hand"}, {"left_hand", "L Finger2"},
      {"right_collar", "R Clavicle"}, {"right_shoulder", "R UpperArm"}, {"right_elbow", "R Forearm"}, {"right_wrist", "R Hand"}, {"right_hand", "R Finger2"}},
     true, true},
    // The Master Motor Map as in KIT and TEMOS, see known_skeletons.hpp. The shoulders are children of the lower neck.
    {"MMM",
     {{"pelvis", "root"}, {"spine1", "BP"}, {"spine2", "BP", "+x+y", {}, "BT", 0.5}, {"spine3", "BT"}, {"neck", "BLN"}, {"head", "BUN"},
      {"left_hip", "LH"}, {"left_knee", "LK"}, {"left_ankle", "LA"}, {"left_foot", "LMrot"},
      {"right_hip", "RH"}, {"right_knee", "RK"}, {"right_ankle", "RA"}, {"right_foot", "RMrot"},
      {"left_shoulder", "LS"}, {"left_elbow", "LE"}, {"left_wrist", "LW"},
      {"right_shoulder", "RS"}, {"right_elbow", "RE"}, {"right_wrist", "RW"}},
     true, true},
};
// clang-format on

}  // namespace detail

MOTIONLANG_BODY const std::vector<SkeletonTable>& skeleton_tables() {
  static const std::vector<SkeletonTable> tables(std::begin(detail::known_tables), std::end(detail::known_tables));
  return tables;
}

MOTIONLANG_BODY const SkeletonTable* find_skeleton_table(const Skeleton& source) {
  const SkeletonTable* best = nullptr;
  std::pair<bool, int> most{};
  for (const SkeletonTable& table : skeleton_tables()) {
    if (!table.missing(source).empty()) continue;
    const std::pair fits(detail::StandingSkeleton(source, table).lies().empty(), table.found(source));
    if (best == nullptr || fits > most) best = &table, most = fits;
  }
  return best;
}

MOTIONLANG_BODY const SkeletonTable& detect_skeleton_table(const Skeleton& source) {
  if (const SkeletonTable* fits = find_skeleton_table(source)) return *fits;
  const SkeletonTable* closest = &skeleton_tables().front();
  for (const SkeletonTable& table : skeleton_tables()) {
    if (table.found(source) > closest->found(source)) closest = &table;
  }
  raise<config_error>(103, "detect_skeleton_table: no table fits a skeleton of ", source.size(), " joints (root '",
                      source.names.front(), "'); the closest, ", closest->name, ", needs a joint '",
                      closest->missing(source), "'; ", detail::own_table_hint);
}

MOTIONLANG_BODY const SkeletonTable& skeleton_table(std::string_view name) {
  for (const SkeletonTable& table : skeleton_tables()) {
    if (table.name == name) return table;
  }
  raise<config_error>(103, "skeleton_table: no table '", name, "'");
}

MOTIONLANG_NAMESPACE_END
