// SPDX-License-Identifier: MIT
// Bodies of standing_skeleton.hpp.
#pragma once

#include <cmath>    // atan2, round
#include <numbers>  // pi
#include <utility>  // move

#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/geometry/degree.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/standing_skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline Vec3<double> local_axis(std::string_view signed_letter) {
  const double sign = signed_letter[0] == '-' ? -1 : 1;
  const char c = signed_letter[1];
  return {c == 'x' ? sign : 0, c == 'y' ? sign : 0, c == 'z' ? sign : 0};
}

MOTIONLANG_BODY bool is_axes(std::string_view axes) {
  const auto sign = [](char c) { return c == '+' || c == '-'; };
  const auto letter = [](char c) { return c >= 'x' && c <= 'z'; };
  return axes.size() == 4 && sign(axes[0]) && letter(axes[1]) && sign(axes[2]) && letter(axes[3]) && axes[1] != axes[3];
}

MOTIONLANG_BODY Quaternion<double> axes_rotation(const MappedJoint& joint) {
  const std::string_view axes = joint.axes;
  if (!is_axes(axes))
    raise<config_error>(103, "SkeletonTable: '", axes, "' of '", joint.source, "' does not name two axes");
  const Vec3<double> left = local_axis(axes.substr(0, 2)), up = local_axis(axes.substr(2, 2));
  const auto frame = to_quaternion(Matrix3<double>::from_rows(left, up, cross(left, up)));
  return to_quaternion(AxisAngle<double>{degree * joint.turn}) * frame;
}

MOTIONLANG_BODY std::optional<SkeletonTable> mirrored_table(const SkeletonTable& table) {
  SkeletonTable out = table;
  out.name += ", mirrored";
  for (MappedJoint& m : out.joints) {
    if (m.axes != "+x+y" || m.turn != Vec3<double>{}) return std::nullopt;
    const bool left = m.target.starts_with("left_"), right = m.target.starts_with("right_");
    if (!left && !right) continue;
    const MappedJoint* other = table.find((left ? "right_" : "left_") + m.target.substr(left ? 5 : 6));
    if (other == nullptr) return std::nullopt;
    m.source = other->source, m.second = other->second, m.share = other->share;
  }
  return out;
}

MOTIONLANG_BODY StandingSkeleton StandingSkeleton::of(const Skeleton& s, const SkeletonTable& t) {
  StandingSkeleton own(s, t);
  if (own.lies().empty()) return own;
  if (auto mirrored = mirrored_table(t)) {
    StandingSkeleton other(s, std::move(*mirrored));
    const int left = other.joint("left_shoulder"), right = other.joint("right_shoulder");
    const auto x_of = [&](int j) { return other.position_[static_cast<std::size_t>(j)].x; };
    const bool sides = left >= 0 && right >= 0 && x_of(left) > x_of(right);
    if (sides && other.lies().empty()) return other;
  }
  return own;
}

MOTIONLANG_BODY StandingSkeleton::StandingSkeleton(Skeleton s, SkeletonTable t)
    : skeleton(std::move(s)), table(std::move(t)) {
  const auto joints = static_cast<std::size_t>(skeleton.size());
  rotation.assign(joints, Quaternion<double>::identity());
  position_.assign(joints, {});
  std::vector<bool> given(joints, false);
  for (const MappedJoint& m : table.joints) {
    const int j = find_joint(skeleton, m.source);
    if (j < 0) continue;
    rotation[static_cast<std::size_t>(j)] = axes_rotation(m);
    given[static_cast<std::size_t>(j)] = true;
  }
  for (std::size_t j = 1; j < joints; ++j) {
    const auto parent = static_cast<std::size_t>(skeleton.parents[j]);
    if (!given[j]) rotation[j] = rotation[parent];
    position_[j] = position_[parent] + rotate(rotation[parent], skeleton.offsets[j]);
  }
  face_forward();
}

MOTIONLANG_BODY std::string StandingSkeleton::lies() const {
  const double slant = 0.7;  // cosine of some 45 degrees
  const auto between = [&](std::string_view from, std::string_view to) {
    const int a = joint(from), b = joint(to);
    return a < 0 || b < 0 ? Vec3<double>{}
                          : position_[static_cast<std::size_t>(b)] - position_[static_cast<std::size_t>(a)];
  };
  const auto told = [](const char* what, Vec3<double> v, const char* wanted) {
    v = (1 / norm(v)) * v;
    const auto rounded = [](double x) { return std::round(x * 100) / 100; };
    return concat_text(what, " (", rounded(v.x), ", ", rounded(v.y), ", ", rounded(v.z), ") at rest, ", wanted);
  };
  const Vec3<double> trunk = between("pelvis", "head"), across = between("right_hip", "left_hip");
  if (trunk.y < slant * norm(trunk)) return told("the head is from the pelvis in direction", trunk, "not up (0, 1, 0)");
  if (across.x < slant * norm(across))
    return told("the left hip is from the right one in direction", across, "not to the left (1, 0, 0)");
  const Vec3<double> foot = between("left_ankle", "left_foot");
  if (foot.z < -slant * norm(foot))
    return told("the left toes are from the ankle in direction", foot, "not forward (0, 0, 1) with the left hip at +x");
  return {};
}

MOTIONLANG_BODY std::string StandingSkeleton::role(int joint) const {
  std::string best;
  double largest = 0;
  for (const MappedJoint& m : table.joints) {
    const double share = find_joint(skeleton, m.source) == joint                        ? 1 - m.share
                         : !m.second.empty() && find_joint(skeleton, m.second) == joint ? m.share
                                                                                        : 0;
    if (share > 0 && share >= largest) best = m.target, largest = share;
  }
  return best;
}

MOTIONLANG_BODY Vec3<double> StandingSkeleton::bone(const LimbBone& limb) const {
  const int a = joint(limb.joint), b = joint(limb.end);
  if (a < 0 || b < 0) return {};
  if (!table.straighten) return smpl24_skeleton().offset(smpl24_skeleton()[limb.end]);
  return position_[static_cast<std::size_t>(b)] - position_[static_cast<std::size_t>(a)];
}

MOTIONLANG_BODY double StandingSkeleton::length(const LimbBone& limb) const {
  const int a = joint(limb.joint), b = joint(limb.end);
  if (a < 0 || b < 0) return 0;
  return norm(position_[static_cast<std::size_t>(b)] - position_[static_cast<std::size_t>(a)]);
}

MOTIONLANG_BODY void StandingSkeleton::face_forward() {
  const int left = joint("left_hip"), right = joint("right_hip");
  if (left < 0 || right < 0) return;
  const auto across = position_[static_cast<std::size_t>(left)] - position_[static_cast<std::size_t>(right)];
  constexpr double quarter = std::numbers::pi / 2;
  const double quarters = std::round(std::atan2(-across.z, across.x) / quarter);
  if (quarters == 0) return;
  const auto back = from_axis_angle(Vec3<double>{0, 1, 0}, -quarters * quarter);
  for (Quaternion<double>& q : rotation) q = back * q;
  for (Vec3<double>& p : position_) p = rotate(back, p);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
