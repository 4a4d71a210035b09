// SPDX-License-Identifier: MIT
// Bodies of up_axis.hpp.
#pragma once

#include <algorithm>  // max, min
#include <cmath>      // abs
#include <numbers>    // pi

#include <motionlang/core/quantile.hpp>
#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/kinematics/up_axis.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string_view to_string(UpAxis axis) {
  constexpr std::string_view names[] = {"+Y", "+Y", "+Z", "+X", "-Y", "-Z", "-X"};
  return names[static_cast<std::size_t>(axis)];
}

MOTIONLANG_BODY Vec3<double> up_direction(UpAxis axis) {
  constexpr Vec3<double> directions[] = {{0, 1, 0},  {0, 1, 0},  {0, 0, 1}, {1, 0, 0},
                                         {0, -1, 0}, {0, 0, -1}, {-1, 0, 0}};
  return directions[static_cast<std::size_t>(axis)];
}

MOTIONLANG_BODY Quaternion<double> upright_rotation(UpAxis axis) {
  constexpr double quarter = std::numbers::pi / 2;
  const auto about_x = [](double angle) { return from_axis_angle(Vec3<double>{1, 0, 0}, angle); };
  switch (axis) {
    case UpAxis::z:
      return about_x(-quarter);
    case UpAxis::z_down:
      return about_x(quarter);
    case UpAxis::y_down:
      return about_x(2 * quarter);
    case UpAxis::x:
      return from_axis_angle(Vec3<double>{0, 0, 1}, quarter);
    case UpAxis::x_down:
      return from_axis_angle(Vec3<double>{0, 0, 1}, -quarter);
    default:
      return Quaternion<double>::identity();
  }
}

namespace detail {

MOTIONLANG_BODY Vec3<double> standing_direction(const Skeleton& skeleton, const BodyJoints& body) {
  const auto rest = skeleton.rest_positions();
  auto place = [&](int joint) { return rest[static_cast<std::size_t>(joint)]; };
  return normalized(place(body.head) - 0.5 * (place(body.ankle.left) + place(body.ankle.right)));
}

MOTIONLANG_BODY std::optional<StandingAxis> find_up_axis(const BodyTrack& track, const UprightLimits& limits) {
  using Vec = Vec3<double>;
  const BodyJoints& body = track.body;
  const Index frames = track.columns == 0 ? 0 : std::ssize(track.positions) / track.columns;
  if (frames == 0) return std::nullopt;
  const auto at = [&](Index frame, int joint) {
    return track.positions[static_cast<std::size_t>(frame * track.columns + joint)];
  };
  const auto middle = [&](Index frame, const BodyJoints::Pair& p) {
    return 0.5 * (at(frame, p.left) + at(frame, p.right));
  };
  Vec trunk{}, legs{}, arms{};
  for (Index f = 0; f < frames; ++f) {
    const Vec hips = middle(f, body.hip), shoulders = middle(f, body.shoulder);
    trunk = trunk + normalized(shoulders - hips);
    legs = legs + normalized(hips - middle(f, body.ankle));
    if (body.wrist.known()) arms = arms + (shoulders - middle(f, body.wrist));
  }
  const auto off_floor = [&](const Vec& up) {  // the height of the soles: 5 % of the frames have a foot lower than this
    constexpr double toe_height = 0.02, ankle_height = 0.08;  // m above the sole
    std::vector<double> lowest;
    for (Index f = 0; f < frames; ++f) {
      double low = std::min(dot(up, at(f, body.ankle.left)), dot(up, at(f, body.ankle.right)));
      if (body.toe.known()) low = std::min({low, dot(up, at(f, body.toe.left)), dot(up, at(f, body.toe.right))});
      lowest.push_back(low);
    }
    return std::abs(quantile(std::move(lowest), 0.05) - (body.toe.known() ? toe_height : ankle_height));
  };
  const double share = 1 / static_cast<double>(frames);
  for (const UpAxis axis : {UpAxis::z, UpAxis::z_down, UpAxis::x, UpAxis::x_down, UpAxis::y_down}) {
    const Vec up = up_direction(axis);
    const double along = share * dot(trunk, up);
    if (along < limits.upright || share * dot(legs, up) < limits.upright) continue;
    const bool at_rest = dot(track.at_rest, up) >= limits.upright;
    const bool hanging_arms = axis == UpAxis::y_down && dot(arms, up) > 0;
    if (at_rest || hanging_arms || off_floor(up) <= limits.standing) return StandingAxis{axis, along};
  }
  return std::nullopt;
}

}  // namespace detail

MOTIONLANG_BODY std::optional<StandingAxis> find_up_axis(const Motion& motion) {
  constexpr Index most = 300;  // frames to check
  const auto body = find_body_joints(motion.skeleton);
  if (!body || motion.frames() == 0) return std::nullopt;
  std::vector<Vec3<double>> positions;
  JointTransforms<double> world;
  for (Index f = 0; f < motion.frames(); f += 1 + motion.frames() / most) {
    motion.world(f, world);
    positions.insert(positions.end(), world.position.begin(), world.position.end());
  }
  const auto place = [&](int joint) { return positions[static_cast<std::size_t>(joint)]; };
  const double leg =
      norm(place(body->hip.left) - place(body->knee.left)) + norm(place(body->knee.left) - place(body->ankle.left));
  return detail::find_up_axis(
      {positions, motion.skeleton.size(), *body, detail::standing_direction(motion.skeleton, *body)},
      {.standing = 0.35 * leg});
}

MOTIONLANG_BODY Motion turned_upright(const Motion& motion, const Quaternion<double>& upright) {
  Motion out = motion;
  const auto body = find_body_joints(out.skeleton);
  const bool turn_rest = body && rotate(upright, detail::standing_direction(out.skeleton, *body)).y > 0.7;
  for (Vec3<double>& r : out.root) r = rotate(upright, r);
  for (auto* bones : {&out.skeleton.offsets, &out.skeleton.ends}) {
    for (Vec3<double>& o : *bones) o = turn_rest ? rotate(upright, o) : o;
  }
  for (Index f = 0; f < out.frames(); ++f) {
    const auto pose = out.rotations(f);
    if (turn_rest) {
      for (auto& q : pose) q = upright * q * inverse(upright);
    } else {
      pose[0] = upright * pose[0];
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
