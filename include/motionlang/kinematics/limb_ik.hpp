// SPDX-License-Identifier: MIT
/// Inverse kinematics of a limb of two bones: hip, knee and ankle, or shoulder, elbow and wrist.
#pragma once

#include <span>         // pose
#include <string_view>  // who complains

#include <motionlang/kinematics/forward.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Joints of a limb, each the parent of the next.
struct Limb {
  int upper = 0, middle = 0, end = 0;
};

namespace detail {

/// Throws config_error 103 unless each joint of the limb is the parent of the next.
void require_limb(std::string_view function, const Skeleton& skeleton, const Limb& limb);

}  // namespace detail

/// Bends and turns a limb so that its end comes to `target`, or as near as its bones reach. The middle joint stays in
/// its plane, and the end keeps its rotation in the world.
///    cos(middle) = (l1^2 + l2^2 - r^2) / (2 l1 l2),   r = |target - upper|
/// pose        (joints) local rotations of one frame, changed in place
/// world       the same frame by forward kinematics, before the change; not changed
/// towards     the direction in the world to which the middle joint of a straight limb moves (knees: forward)
/// Throws      config_error 103 if the joints are not connected, shape_error 205 unless there is one rotation for each
///             joint, numeric_error 302 for a bone that is shorter than 0.1 mm
void reach(const Skeleton& skeleton, std::span<Quaternion<double>> pose, const JointTransforms<double>& world,
           const Limb& limb, const Vec3<double>& target, const Vec3<double>& towards);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/limb_ik.ipp>
#endif
