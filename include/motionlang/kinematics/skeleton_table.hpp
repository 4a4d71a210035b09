// SPDX-License-Identifier: MIT
/// Which joint of a kind of skeleton has the part of which joint of SMPL: one table. Those that are known are in
/// skeleton_tables.hpp.
#pragma once

#include <algorithm>  // equal

#include <motionlang/core/text_lines.hpp>
#include <motionlang/kinematics/skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A joint's name without what programs put before it: namespaces ("hero:Hips"), and Mixamo's "mixamorig:", also as
/// "mixamorig1:" and, where colons were lost, "mixamorig".
inline std::string_view bare_joint_name(std::string_view name) {
  name = name.substr(name.rfind(':') + 1);  // npos + 1 = 0
  constexpr std::string_view mixamo = "mixamorig";
  if (!name.starts_with(mixamo)) return name;
  const std::size_t rest = name.find_first_not_of("0123456789_", mixamo.size());
  return rest == name.npos ? name : name.substr(rest);
}

namespace detail {
inline bool same_but_for_capitals(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}
}  // namespace detail

/// The number of a joint by its name, or else by its bare name, or else by that without regard to capital letters
/// ("Hips" is "hips": Unity and Godot write VRM's names so); -1.
inline int find_joint(const Skeleton& skeleton, std::string_view name) {
  if (const int j = skeleton.find(name); j >= 0) return j;
  int similar = -1;
  for (int k = 0; k < skeleton.size(); ++k) {
    const std::string_view bare = bare_joint_name(skeleton.name(k));
    if (bare == name) return k;
    if (similar < 0 && detail::same_but_for_capitals(bare, name)) similar = k;
  }
  return similar;
}

/// One joint of SMPL and the joint of the known skeleton whose orientation it takes.
struct MappedJoint {
  std::string target;  // name in SMPL
  std::string source;
  /// The two local axes of the source joint that point to the left and up while the figure stands in a T-pose. "+x+y"
  /// for files whose rotations are all zero in that pose.
  std::string axes = "+x+y";
  /// How the frame given by `axes` is turned in the T-pose besides: rotation vector in degrees, x left, y up, z
  /// forward.
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
      const bool optional = j.target.ends_with("_hand") || j.target.ends_with("_foot") || j.target.ends_with("_collar");
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

MOTIONLANG_NAMESPACE_END
