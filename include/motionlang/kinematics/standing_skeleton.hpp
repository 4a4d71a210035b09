// SPDX-License-Identifier: MIT
/// A skeleton in its T-pose, by the axes in its table.
#pragma once

#include <optional>     // mirrored tables
#include <string>       // roles
#include <string_view>  // roles
#include <vector>       // rotations

#include <motionlang/geometry/quaternion.hpp>
#include <motionlang/kinematics/skeleton_table.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A joint of a limb and the joint at the end of its bone, by SMPL's names.
struct LimbBone {
  std::string_view joint, end;
};

/// True if a text names two different axes, such as "+x+y".
bool is_axes(std::string_view axes);
/// World rotation of a joint in a T-pose, from "+x+y": its local axes that point left and up.
Quaternion<double> axes_rotation(const MappedJoint& joint);

/// The table of a mirror image, in which each side has the names of the other. Nothing for a table with turns or axes
/// other than "+x+y", which a mirror changes.
std::optional<SkeletonTable> mirrored_table(const SkeletonTable& table);

/// A skeleton in the T-pose of its table, turned by quarters of a circle about y until its left is nearest to +X. If
/// its limbs do not point to the sides or down, `bone` has their directions.
class StandingSkeleton {
 public:
  Skeleton skeleton;
  SkeletonTable table;
  std::vector<Quaternion<double>> rotation;  // of each joint in the world

  StandingSkeleton(Skeleton s, SkeletonTable t);
  /// The skeleton by its table, or by the mirrored table if it stands only by that, shoulders as well as hips.
  static StandingSkeleton of(const Skeleton& s, const SkeletonTable& t);

  /// The reason why it does not stand and face forward: the head is not over the pelvis, the hips are not side by side,
  /// or toes point back because left and right are exchanged. "" if it stands, or lacks these joints.
  std::string lies() const;

  /// The joint with a role, which is a name of SMPL's; -1 if there is none.
  int joint(std::string_view role) const {
    const MappedJoint* row = table.find(role);
    return row == nullptr ? -1 : find_joint(skeleton, row->source);
  }
  /// The role of a joint: the one with its largest share, the last among equals. "" if it has none.
  std::string role(int joint) const;
  /// A bone of a limb; zero without its joints. If the table says that the zero pose is the T-pose although bones are
  /// not straight, the bone is that of SMPL.
  Vec3<double> bone(const LimbBone& limb) const;
  double length(const LimbBone& limb) const;

 private:
  void face_forward();

  std::vector<Vec3<double>> position_;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/standing_skeleton.ipp>
#endif
