// SPDX-License-Identifier: MIT
/// One table that maps the joints of a kind of skeleton to those of SMPL. The known ones are in skeleton_tables.hpp.
#pragma once

#include <motionlang/kinematics/skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A joint's name without prefixes of programs: namespaces ("hero:Hips"), and Mixamo's "mixamorig:", also as
/// "mixamorig1:" and, without its colon, "mixamorig".
std::string_view bare_joint_name(std::string_view name);

/// The common beginning of the names of at least three quarters of the joints, up to a separator: "Character1_",
/// "ValveBiped.Bip01_". "" if they have none in common.
std::string common_name_prefix(const Skeleton& skeleton);

/// The number of a joint: by its name, else by its bare name, else by that in any case ("Hips" is "hips": Unity and
/// Godot write VRM's names so) and with any blanks ("L_Thigh" is "L Thigh"), else by that without the common prefix. -1
/// if none.
int find_joint(const Skeleton& skeleton, std::string_view name);

/// One joint of SMPL and the joint of the known skeleton whose orientation it takes.
struct MappedJoint {
  std::string target;  // name in SMPL
  std::string source;
  /// The two local axes of the source joint that point to the left and up in the T-pose. "+x+y" for files in which all
  /// rotations are zero in that pose.
  std::string axes = "+x+y";
  /// An additional turn of the frame that `axes` gives in the T-pose: rotation vector in degrees, x left, y up, z
  /// forward.
  Vec3<double> turn{};
  /// A second source joint and its share, for chains of different lengths. Its axes are those of its own row, otherwise
  /// of its parent.
  std::string second{};
  double share = 0;

  /// True if a skeleton may lack the source: hands, toes and collars.
  bool optional() const {
    return target.ends_with("_hand") || target.ends_with("_foot") || target.ends_with("_collar");
  }
};

/// A kind of skeleton. Hands, toes and collars may be missing; all other joints of the table must be there.
struct SkeletonTable {
  std::string name;
  std::vector<MappedJoint> joints;
  /// True if limbs are turned so that the source's bones take the directions of the target's. False if the zero pose
  /// (with `turn`) is known to be the T-pose although its bones are not straight.
  bool straighten = true;
  /// True if the soles are level in the zero pose although the legs are apart, as in the bind pose of a character's
  /// skin. Otherwise feet lean to the side with their shins.
  bool level_soles = false;

  const MappedJoint* find(std::string_view target) const;
  /// The first joint that the table needs and the skeleton lacks; empty if there is none.
  std::string missing(const Skeleton& source) const;
  /// The number of its joints that the skeleton has.
  int found(const Skeleton& source) const;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/skeleton_table.ipp>
#endif
