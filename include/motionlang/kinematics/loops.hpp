// SPDX-License-Identifier: MIT
/// Finds cycles in a clip (steps, waving, breathing), and makes clips longer by repeating them.
#pragma once

#include <algorithm>  // min
#include <optional>   // clips without a cycle

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Frames first and last look alike, so that after `last - 1` the clip may continue at `first`.
struct Loop {
  Index first = 0, last = 0;
  double cost = 0;  // mean distance of joints, metres, velocities included
};

namespace detail {

/// The rotation about the vertical in a quaternion.
inline double heading(const Quaternion<double>& q) { return 2 * std::atan2(q.y, q.w); }
inline Quaternion<double> turn(double angle) { return from_axis_angle(Vec3<double>{0, 1, 0}, angle); }

/// Joint positions with the root's place and heading removed, (frames, joints).
std::vector<Vec3<double>> poses_in_place(const Motion& motion);

}  // namespace detail

/// The best cycle of at least `least` frames, if its cost is below `most` metres.
///     cost(a, b) = mean over joints of |p_a - p_b| + 0.1 s |v_a - v_b|
/// Throws config_error 101 unless least >= 1.
std::optional<Loop> find_loop(const Motion& motion, Index least, double most = 0.08);

/// The clip up to loop.last, then repetitions of the loop until there are `frames` frames. Each round continues at the
/// end of the one before, in its direction. The remaining difference between the ends fades out over `blend` frames.
Motion go_round(const Motion& motion, const Loop& loop, Index frames, Index blend = 8);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/loops.ipp>
#endif
