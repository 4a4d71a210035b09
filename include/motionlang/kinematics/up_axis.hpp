// SPDX-License-Identifier: MIT
/// Finds the axis of a file that points up if it is not Y. Some programs have Z up, and in cameras Y points down.
///
///     if (const auto stands = find_up_axis(motion)) motion = turned_upright(motion, stands->axis);
#pragma once

#include <optional>     // other axes
#include <string_view>  // names

#include <motionlang/kinematics/body_joints.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The axis that points up. `y_down`: -Y points up, as in the coordinates of a camera.
enum class UpAxis { found, y, z, x, y_down, z_down, x_down };

/// "+Y", "-Z".
std::string_view to_string(UpAxis axis);
/// The axis as a vector of length 1, (0, 1, 0) for `found`.
Vec3<double> up_direction(UpAxis axis);
/// The rotation that turns the axis to +Y, about x if possible.
Quaternion<double> upright_rotation(UpAxis axis);

/// The motion with another axis turned to +Y. If the rest pose stands along that axis, too, it is turned as well.
/// Otherwise, and if no table describes the rest pose, only the root is turned. Positions are the same in both cases.
Motion turned_upright(const Motion& motion, const Quaternion<double>& upright);
inline Motion turned_upright(const Motion& motion, UpAxis axis) {
  return turned_upright(motion, upright_rotation(axis));
}

/// The axis along which a body stands.
struct StandingAxis {
  UpAxis axis;
  double share;  // mean part of the trunk's direction along it; 1: exactly
};

/// The axis other than +Y along which trunk and legs are, in the mean over the frames. The rest pose must stand along
/// it, too, or feet must be on the floor; otherwise the body is lying. If it is upside down, arms that hang towards the
/// feet distinguish a camera's coordinates from a handstand. Nothing for a body that stands along +Y or along no axis,
/// and if no table of joints fits.
std::optional<StandingAxis> find_up_axis(const Motion& motion);

namespace detail {

/// From the ankles to the head in the rest pose; length 1.
Vec3<double> standing_direction(const Skeleton& skeleton, const BodyJoints& body);

/// A body as joints over frames.
struct BodyTrack {
  std::span<const Vec3<double>> positions;  // (frames, columns), the joints of `body` among them
  Index columns = 0;
  BodyJoints body{};
  Vec3<double> at_rest{};  // standing_direction
};
struct UprightLimits {
  double upright = 0.8;   // mean direction of trunk and legs along an axis; 1: exactly
  double standing = 0.3;  // distance of the feet from 0 along an axis along which the rest pose does not stand
};
std::optional<StandingAxis> find_up_axis(const BodyTrack& track, const UprightLimits& limits);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/up_axis.ipp>
#endif
