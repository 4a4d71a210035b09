// SPDX-License-Identifier: MIT
/// Retargeting: the same movement on another skeleton, from and to every kind in skeleton_tables.hpp.
///
///     G_t(f) = G_s(f) C_s^-1 C_t
/// G_s, G_t: world rotations of a joint s of the source, and of the joint t of the target that follows it. C_t: the
/// world rotation of t while the target stands in its T-pose, facing +Z. C_s: the world rotation of s while the source
/// stands in the same pose, with its limbs along the target's. So a source in that pose gives the target's T-pose, for
/// any local axes and rest poses (T, A, any quarter turn). Chains may have different numbers of joints. Joints that no
/// table knows follow those of the same name, and fingers those of the same finger. Bones keep the target's lengths;
/// the path is scaled by the ratio of the legs.
#pragma once

#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/kinematics/skeleton_tables.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {
class StandingSkeleton;
}

/// The report of a map about the joints that it matched.
struct RetargetReport {
  std::string table, target_table;                          // the kinds of source and target
  std::vector<std::pair<std::string, std::string>> mapped;  // joint of the target, joint (or "a + b") of the source
  std::vector<std::string> unmapped;                        // joints of the target that stay at rest
  std::vector<std::string> unused;                          // joints of the source without a follower
  double leg_ratio = 1, arm_ratio = 1;  // target / source, 0 without arms; the path is scaled by leg_ratio
};
std::string to_string(const RetargetReport& r);

/// A map from one skeleton to another. Make it once and use it for every clip. A mirror image, whose left side has the
/// names of the right one, is mapped by its appearance.
class SkeletonMap {
 public:
  /// Throws config_error 103 with the name of a joint that the source's table needs and the source lacks, for unknown
  /// axes, for missing hips, and if a skeleton is not in the rest pose of its table. Throws 101 if the legs of a
  /// skeleton have no length.
  SkeletonMap(const Skeleton& source, const SkeletonTable& source_table, const Skeleton& target,
              const SkeletonTable& target_table);
  /// For a target with SMPL's names.
  SkeletonMap(const Skeleton& source, const Skeleton& target, const SkeletonTable& source_table)
      : SkeletonMap(source, source_table, target, skeleton_table("SMPL")) {}
  /// With the built-in tables that fit.
  explicit SkeletonMap(const Skeleton& source, const Skeleton& target = smpl24_skeleton())
      : SkeletonMap(source, detect_skeleton_table(source), target, detect_skeleton_table(target)) {}

  const Skeleton& source() const { return source_; }
  const Skeleton& target() const { return target_; }
  const RetargetReport& report() const { return report_; }

  /// Converts one frame: world transforms of the source to root position and local rotations of the target.
  void apply(const JointTransforms<double>& from, Vec3<double>& root, std::span<Quaternion<double>> local) const;

 private:
  struct Link {
    int source = -1, second = -1;
    Quaternion<double> undo{1, 0, 0, 0}, undo_second{1, 0, 0, 0};  // C_s^-1 C_t
    Quaternion<double> at_rest{1, 0, 0, 0};  // of a joint that follows none, relative to its parent
    double share = 0;
  };

  static Quaternion<double> turned(const JointTransforms<double>& from, int joint, const Quaternion<double>& undo) {
    return to_quaternion(from.rotation[static_cast<std::size_t>(joint)]) * undo;
  }
  static const Vec3<double>& position(const JointTransforms<double>& from, int joint) {
    return from.position[static_cast<std::size_t>(joint)];
  }
  /// A joint of the target relative to its root.
  Vec3<double> from_root(int joint, const std::vector<Quaternion<double>>& world) const;

  /// For joints that no table knows: the joint of the same name, or the same joint of the same finger. -1 if none.
  int namesake(const std::string& name) const;
  void connect(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to);

  /// The rotation of a joint of the source from its T-pose to the target's pose. Limbs are turned joint by joint. Feet
  /// only roll with their shins, unless a table says that their soles are level. The trunk stays as it is.
  static Quaternion<double> bone_turn(std::string_view role, const detail::StandingSkeleton& from,
                                      const detail::StandingSkeleton& to, const Quaternion<double>& up);

  /// Measures the lengths of legs and arms, and the places of the hips.
  void measure(const detail::StandingSkeleton& from, const detail::StandingSkeleton& to);

  Skeleton source_, target_;
  RetargetReport report_;
  std::vector<Link> links_;  // of the target's joints
  int left_hip_ = -1, right_hip_ = -1, target_left_hip_ = -1, target_right_hip_ = -1;
};

/// Moves a clip up or down so that its feet stand on y = 0, as in the rest pose. In all frames except the lowest 5 %,
/// the lowest joint is then not below the lowest joint at rest. A rest pose below the floor says nothing about the
/// floor (the root of many BVH files has OFFSET 0); then that joint itself is at y = 0. Returns the distance by which
/// the clip was moved.
double place_on_floor(Motion& motion);

struct RetargetOptions {
  bool floor = true;  // place_on_floor
};

/// The clip on the target of the map. Throws config_error 106 if its skeleton is not the source of the map.
Motion retarget(const Motion& motion, const SkeletonMap& map, const RetargetOptions& options = {});
/// Uses the built-in tables that fit the clip and the target. A motion on the target's skeleton is not changed. Throws
/// config_error 103 with the missing joint.
Motion retarget(const Motion& motion, const Skeleton& target = smpl24_skeleton(), const RetargetOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/retarget.ipp>
#endif
