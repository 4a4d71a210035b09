// SPDX-License-Identifier: MIT
/// Where a clip stands and goes on the floor: moving a whole clip, clips in place, and the path of the root as a track
/// of its own, as game engines want it. Y up, metres, radians; a turn to the left is positive.
#pragma once

#include <numbers>  // pi
#include <vector>   // track

#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The turn about the vertical that brings rotation `from` nearest to `to`, in [-pi, pi]. Whatever the local axes of
/// the root are: turn_between(q, Ry(a) q) = a.
///     max over a of |<to, Ry(a) from>|:   a = 2 atan2(d_y, d_w),   d = to from^-1
inline double turn_between(const Quaternion<double>& from, const Quaternion<double>& to) {
  const Quaternion<double> d = to * inverse(from);
  return std::remainder(2 * std::atan2(d.y, d.w), 2 * std::numbers::pi);
}

/// A clip moved over the floor.   p' = Ry(turn) p + shift
struct Placement {
  double turn = 0;
  Vec3<double> shift{};

  Quaternion<double> rotation() const { return from_axis_angle(Vec3<double>{0, 1, 0}, turn); }
  Vec3<double> operator()(const Vec3<double>& p) const { return rotate(rotation(), p) + shift; }
};

/// The transform that moves the root in frame `from` of one clip over the place and heading of the root in frame `to`
/// of another. Heights stay. The frames exist.
Placement placement_between(const Motion& clip, Index from, const Motion& other, Index to);

/// The whole clip moved.
Motion placed(const Motion& motion, const Placement& placement);

struct InPlaceOptions {
  bool keep_height = true;  // false: the root stays at the height of the first frame
};
/// The clip with its root over the origin, x = z = 0, in all frames. Rotations stay, headings with them.
Motion in_place(const Motion& motion, const InPlaceOptions& options = {});

/// The way of a root over the floor.
struct RootMotion {
  double fps = 20;
  std::vector<Vec3<double>> position;  // (frames), y = 0
  std::vector<double> heading;         // (frames), 0 in the first; continuous, so that two turns are 4 pi
};
struct ExtractedRoot {
  RootMotion path;
  Motion pose;  // in place, and always facing where the first frame faces
};

/// Takes the way of the root out of a clip. apply_root_motion puts it back.
///     position = (x, 0, z) of the root,   heading_f = turn_between(q_0, q_f)
///     pose: root (0, y, 0), rotation of the root Ry(-heading_f) q_f, all others as they are
ExtractedRoot extract_root_motion(const Motion& motion);

/// A clip carried along a path, frame by frame. Throws shape_error 204 unless both have as many frames.
Motion apply_root_motion(const Motion& pose, const RootMotion& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/root_motion.ipp>
#endif
