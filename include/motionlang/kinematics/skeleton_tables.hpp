// SPDX-License-Identifier: MIT
/// Which joint of a known skeleton has the part of which joint of SMPL: the tables behind retargeting, and how to
/// recognise one. They are read in both directions: SMPL's 24 joints are what all skeletons have in common.
#pragma once

#include <motionlang/kinematics/skeleton.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// A joint's name without what programs put before it: namespaces ("hero:Hips"), and Mixamo's "mixamorig:", also as
/// "mixamorig1:" and, where colons were lost, "mixamorig".
inline std::string_view bare_joint_name(std::string_view name) {
  name = name.substr(name.rfind(':') + 1);  // npos + 1 = 0
  constexpr std::string_view mixamo = "mixamorig";
  if (!name.starts_with(mixamo)) return name;
  const std::size_t rest = name.find_first_not_of("0123456789_", mixamo.size());
  return rest == name.npos ? name : name.substr(rest);
}
/// The number of a joint by its name or else by its bare name; -1.
inline int find_joint(const Skeleton& skeleton, std::string_view name) {
  int j = skeleton.find(name);
  for (int k = 0; k < skeleton.size() && j < 0; ++k) {
    if (bare_joint_name(skeleton.name(k)) == name) j = k;
  }
  return j;
}

/// One joint of SMPL and the joint of the known skeleton whose orientation it takes.
struct MappedJoint {
  std::string target;  // name in SMPL
  std::string source;
  /// The two local axes of the source joint that point to the left and up while the figure stands in a T-pose. "+x+y"
  /// for files whose rotations are all zero in that pose.
  std::string axes = "+x+y";
  /// How the frame given by `axes` is turned in the T-pose besides: rotation vector in degrees, x left, y up, z forward.
  Vec3<double> turn{};
  /// A second source joint and its share, for chains of different lengths. Its axes are those of its own row, else of
  /// its parent.
  std::string second{};
  double share = 0;
};

/// A kind of skeleton. Hands, toes and collars may be missing; all other joints of the table must be there.
struct SkeletonTable {
  std::string name;
  std::vector<MappedJoint> joints;
  /// Whether limbs are turned so that the source's bones take the directions of the target's; false where the zero pose
  /// (with `turn`) is known to be the T-pose although its bones are not straight.
  bool straighten = true;
  /// Whether the soles are level in the zero pose although the legs stand apart, as in the pose to which a character's
  /// skin is bound. Otherwise feet lean to the side with their shins.
  bool level_soles = false;

  const MappedJoint* find(std::string_view target) const {
    for (const MappedJoint& j : joints) {
      if (j.target == target) return &j;
    }
    return nullptr;
  }
  /// The first joint that the table needs and the skeleton lacks; empty if there is none.
  std::string missing(const Skeleton& source) const {
    for (const MappedJoint& j : joints) {
      const bool optional =
          j.target.ends_with("_hand") || j.target.ends_with("_foot") || j.target.ends_with("_collar");
      if (!optional && find_joint(source, j.source) < 0) return j.source;
      if (!j.second.empty() && find_joint(source, j.second) < 0) return j.second;
    }
    return {};
  }
  /// How many of its joints the skeleton has.
  int found(const Skeleton& source) const {
    int n = 0;
    for (const MappedJoint& j : joints) n += find_joint(source, j.source) >= 0 ? 1 : 0;
    return n;
  }
};

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
      table.joints.push_back({std::string(j.target), std::string(j.source), std::string(j.axes), j.turn,
                              std::string(j.second), j.share});
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
    // Rigs of game characters: as GLB files hold them, rest rotations are taken out, so that all axes are "+x+y".
    {"Mixamo",
     {{"pelvis", "Hips"}, {"spine1", "Spine"}, {"spine2", "Spine1"}, {"spine3", "Spine2"}, {"neck", "Neck"}, {"head", "Head"},
      {"left_hip", "LeftUpLeg"}, {"left_knee", "LeftLeg"}, {"left_ankle", "LeftFoot"}, {"left_foot", "LeftToeBase"},
      {"right_hip", "RightUpLeg"}, {"right_knee", "RightLeg"}, {"right_ankle", "RightFoot"}, {"right_foot", "RightToeBase"},
      {"left_collar", "LeftShoulder"}, {"left_shoulder", "LeftArm"}, {"left_elbow", "LeftForeArm"}, {"left_wrist", "LeftHand"}, {"left_hand", "LeftHandMiddle1"},
      {"right_collar", "RightShoulder"}, {"right_shoulder", "RightArm"}, {"right_elbow", "RightForeArm"}, {"right_wrist", "RightHand"}, {"right_hand", "RightHandMiddle1"}},
     true, true},
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
    // The humanoid bones of VRM. Files name their joints as they like and say which bone each is; VRoid's names are below.
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
    {"VRoid",
     {{"pelvis", "J_Bip_C_Hips"}, {"spine1", "J_Bip_C_Spine"}, {"spine2", "J_Bip_C_Chest"}, {"spine3", "J_Bip_C_UpperChest"}, {"neck", "J_Bip_C_Neck"}, {"head", "J_Bip_C_Head"},
      {"left_hip", "J_Bip_L_UpperLeg"}, {"left_knee", "J_Bip_L_LowerLeg"}, {"left_ankle", "J_Bip_L_Foot"}, {"left_foot", "J_Bip_L_ToeBase"},
      {"right_hip", "J_Bip_R_UpperLeg"}, {"right_knee", "J_Bip_R_LowerLeg"}, {"right_ankle", "J_Bip_R_Foot"}, {"right_foot", "J_Bip_R_ToeBase"},
      {"left_collar", "J_Bip_L_Shoulder"}, {"left_shoulder", "J_Bip_L_UpperArm"}, {"left_elbow", "J_Bip_L_LowerArm"}, {"left_wrist", "J_Bip_L_Hand"}, {"left_hand", "J_Bip_L_Middle1"},
      {"right_collar", "J_Bip_R_Shoulder"}, {"right_shoulder", "J_Bip_R_UpperArm"}, {"right_elbow", "J_Bip_R_LowerArm"}, {"right_wrist", "J_Bip_R_Hand"}, {"right_hand", "J_Bip_R_Middle1"}},
     true, true},
    // The Master Motor Map as KIT and TEMOS have it, see standard.hpp. The joints of the shoulders hang on the lower neck.
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

/// The built-in tables.
inline const std::vector<SkeletonTable>& skeleton_tables() {
  static const std::vector<SkeletonTable> tables(std::begin(detail::known_tables), std::end(detail::known_tables));
  return tables;
}

/// The table whose joints the skeleton has; of several the one with the most. Null if none fits.
inline const SkeletonTable* find_skeleton_table(const Skeleton& source) {
  const SkeletonTable* best = nullptr;
  for (const SkeletonTable& table : skeleton_tables()) {
    if (!table.missing(source).empty()) continue;
    if (best == nullptr || table.found(source) > best->found(source)) best = &table;
  }
  return best;
}
/// The same. Throws config_error 103 with the joint that the closest table misses if none fits.
inline const SkeletonTable& detect_skeleton_table(const Skeleton& source) {
  if (const SkeletonTable* fits = find_skeleton_table(source)) return *fits;
  const SkeletonTable* closest = &skeleton_tables().front();
  for (const SkeletonTable& table : skeleton_tables()) {
    if (table.found(source) > closest->found(source)) closest = &table;
  }
  raise<config_error>(103, "detect_skeleton_table: no table fits a skeleton of ", source.size(), " joints (root '",
                      source.names.front(), "'); the closest, ", closest->name, ", needs a joint '",
                      closest->missing(source), "'");
}
/// A built-in table by name. Throws config_error 103.
inline const SkeletonTable& skeleton_table(std::string_view name) {
  for (const SkeletonTable& table : skeleton_tables()) {
    if (table.name == name) return table;
  }
  raise<config_error>(103, "skeleton_table: no table '", name, "'");
}

}  // namespace motionlang::inline MOTIONLANG_ABI
