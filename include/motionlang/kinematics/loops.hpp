// SPDX-License-Identifier: MIT
/// Cycles in a clip (steps, waving, breathing) and clips made longer by going round them.
#pragma once

#include <algorithm>  // min
#include <optional>   // clips without a cycle

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Frames first and last look alike, so that after `last - 1` the clip may go on at `first`.
struct Loop {
  Index first = 0, last = 0;
  double cost = 0;  // mean distance of joints, metres, velocities included
};

namespace detail {

/// Rotation about the vertical that a quaternion contains.
inline double heading(const Quaternion<double>& q) { return 2 * std::atan2(q.y, q.w); }
inline Quaternion<double> turn(double angle) { return from_axis_angle(Vec3<double>{0, 1, 0}, angle); }

/// Joint positions with the root's place and heading removed, (frames, joints).
std::vector<Vec3<double>> poses_in_place(const Motion& motion);

}  // namespace detail

/// The best cycle of at least `least` frames, if its cost is below `most` metres.
///     cost(a, b) = mean over joints of |p_a - p_b| + 0.1 s |v_a - v_b|
/// Throws config_error 101 unless least >= 1.
std::optional<Loop> find_loop(const Motion& motion, Index least, double most = 0.08);

/// The clip up to loop.last, then round the loop until there are `frames` frames. Each round goes on from where the
/// last one was, in its direction; what is left of the difference between the ends fades away over `blend` frames.
Motion go_round(const Motion& motion, const Loop& loop, Index frames, Index blend = 8);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/loops.ipp>
#endif
