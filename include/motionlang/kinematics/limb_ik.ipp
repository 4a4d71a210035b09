// SPDX-License-Identifier: MIT
// Bodies of limb_ik.hpp.
#pragma once

#include <algorithm>  // clamp
#include <cmath>      // acos

#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/limb_ik.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void require_limb(std::string_view function, const Skeleton& skeleton, const Limb& limb) {
  auto hangs_on = [&](int joint, int parent) {
    return parent >= 0 && joint >= 0 && joint < skeleton.size() && skeleton.parent(joint) == parent;
  };
  if (!hangs_on(limb.end, limb.middle) || !hangs_on(limb.middle, limb.upper)) {
    raise<config_error>(103, function, ": joints ", limb.upper, ", ", limb.middle, ", ", limb.end,
                        " are not a limb of a skeleton of ", skeleton.size());
  }
}

}  // namespace detail

MOTIONLANG_BODY void reach(const Skeleton& skeleton, std::span<Quaternion<double>> pose,
                           const JointTransforms<double>& world, const Limb& limb, const Vec3<double>& target,
                           const Vec3<double>& towards) {
  detail::require_limb("reach", skeleton, limb);
  if (std::ssize(pose) != skeleton.size())
    raise<shape_error>(205, "reach: ", pose.size(), " rotations for ", skeleton.size(), " joints");
  const auto upper = static_cast<std::size_t>(limb.upper), middle = static_cast<std::size_t>(limb.middle),
             end = static_cast<std::size_t>(limb.end);
  const Vec3<double> a = world.position[upper], b = world.position[middle], c = world.position[end];
  const double l1 = norm(b - a), l2 = norm(c - b);
  constexpr double slack = 1e-4;  // a limb never becomes quite straight, because its plane would be lost
  if (std::min(l1, l2) < slack) raise<numeric_error>(302, "reach: bones of ", l1, " m and ", l2, " m");
  const double r = std::clamp(norm(target - a), std::abs(l1 - l2) + slack, l1 + l2 - slack);
  auto angle = [](const Vec3<double>& u, const Vec3<double>& v) {
    return std::acos(std::clamp(dot(normalized(u), normalized(v)), -1.0, 1.0));
  };
  auto corner = [](double left, double right, double opposite) {
    return std::acos(std::clamp((left * left + right * right - opposite * opposite) / (2 * left * right), -1.0, 1.0));
  };
  const Vec3<double> plane = cross(c - a, b - a);
  const Vec3<double> axis = norm(plane) > 1e-6 ? normalized(plane) : normalized(cross(c - a, towards));
  const auto at_upper = from_axis_angle(axis, corner(l1, r, l2) - angle(c - a, b - a));
  const auto at_middle = from_axis_angle(axis, corner(l1, l2, r) - angle(a - b, c - b));
  const auto aim = rotation_between(normalized(c - a), normalized(target - a));

  const std::size_t above = skeleton.parents[upper] < 0 ? upper : static_cast<std::size_t>(skeleton.parents[upper]);
  const auto parent =
      skeleton.parents[upper] < 0 ? Quaternion<double>::identity() : to_quaternion(world.rotation[above]);
  const auto upper_now = aim * at_upper * to_quaternion(world.rotation[upper]);
  const auto middle_now = aim * at_upper * at_middle * to_quaternion(world.rotation[middle]);
  pose[upper] = normalized(inverse(parent) * upper_now);
  pose[middle] = normalized(inverse(upper_now) * middle_now);
  pose[end] = normalized(inverse(middle_now) * to_quaternion(world.rotation[end]));
}

MOTIONLANG_NAMESPACE_END
