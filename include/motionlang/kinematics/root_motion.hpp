// SPDX-License-Identifier: MIT
/// The place and path of a clip on the floor: moving a whole clip, clips in place, and the path of the root as a track
/// of its own for game engines. Y up, metres, radians; a turn to the left is positive.
#pragma once

#include <numbers>  // pi
#include <vector>   // track

#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The turn about the vertical that brings rotation `from` nearest to `to`, in [-pi, pi]. It does not depend on the
/// local axes of the root: turn_between(q, Ry(a) q) = a.
///    max over a of |<to, Ry(a) from>|:   a = 2 atan2(d_y, d_w),   d = to from^-1
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

/// The transform that moves the root in frame `from` of one clip to the place and heading of the root in frame `to` of
/// another. Heights stay. Both frames must exist.
Placement placement_between(const Motion& clip, Index from, const Motion& other, Index to);

/// The whole clip moved.
Motion placed(const Motion& motion, const Placement& placement);

struct InPlaceOptions {
  bool keep_height = true;  // false: the root stays at the height of the first frame
};
/// The clip with its root over the origin, x = z = 0, in all frames. Rotations, and so headings, stay.
Motion in_place(const Motion& motion, const InPlaceOptions& options = {});

/// The path of a root over the floor.
struct RootMotion {
  double fps = 20;
  std::vector<Vec3<double>> position;  // (frames), y = 0
  std::vector<double> heading;         // (frames), 0 in the first; continuous, so that two turns are 4 pi
};
struct ExtractedRoot {
  RootMotion path;
  Motion pose;  // in place, always with the heading of the first frame
};

/// Removes the path of the root from a clip. apply_root_motion adds it again.
///    position = (x, 0, z) of the root,   heading_f = turn_between(q_0, q_f)
///    pose: root (0, y, 0), rotation of the root Ry(-heading_f) q_f, all others unchanged
ExtractedRoot extract_root_motion(const Motion& motion);

/// A clip moved along a path, frame by frame. Throws shape_error 204 unless both have the same number of frames.
Motion apply_root_motion(const Motion& pose, const RootMotion& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/root_motion.ipp>
#endif
