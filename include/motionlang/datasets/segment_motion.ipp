// SPDX-License-Identifier: MIT
// Bodies of segment_motion.hpp.
#pragma once

#include <algorithm>  // max, min
#include <cmath>      // round
#include <tuple>      // tie
#include <utility>    // pair

#include <motionlang/datasets/segment_motion.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/floor_fix.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/treadmill.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY double pose_distance(const Vec3<double>* a, const Vec3<double>* b, Index joints) {
  double sum = 0;
  for (Index j = 0; j < joints; ++j) sum += norm(a[j] - b[j]);
  return sum / static_cast<double>(joints);
}

/// The motion with copies of its last frame at the end.
inline Motion with_last_pose(Motion motion, Index copies) {
  const auto pose = motion.rotations(motion.frames() - 1);
  const std::vector<Quaternion<double>> last(pose.begin(), pose.end());
  for (Index k = 0; k < copies; ++k) {
    motion.root.push_back(motion.root.back());
    motion.local.insert(motion.local.end(), last.begin(), last.end());
  }
  return motion;
}

/// The action with rounds of a cycle after it, and the last of these rounds.
inline std::pair<Motion, Loop> with_rounds(const Motion& action, const Motion& cycle) {
  constexpr Index blend = 6;  // frames
  const Index round = cycle.frames() - 1;
  const Motion rounds = go_round(cycle, {0, round}, 2 * round + 2);
  Motion both = blend_into(action, rounds, std::min({blend, action.frames(), round}));
  const Index first = both.frames() - 2 - round;
  return {std::move(both), Loop{first, first + round}};
}

/// Throws io_error 403 if the cycle of a line does not end as it begins.
inline void require_cycle(const ClipLine& line, const Motion& motion) {
  constexpr double most = 0.08;  // metres
  const auto poses = poses_in_place(motion);
  const Index joints = motion.skeleton.size();
  const double apart = pose_distance(poses.data(), poses.data() + (motion.frames() - 1) * joints, joints);
  if (motion.frames() < 4 || apart > most)
    raise_clip_line(line, concat_text("'", line.clip, "' is to repeat, but its ", counted(motion.frames(), "frame"),
                                      " end ", std::round(apart * 1000) / 1000, " m from where they begin"));
}

}  // namespace detail

MOTIONLANG_BODY SegmentMotion segment_motion(const ClipLine& line,
                                             const std::function<Motion(const ClipLine&)>& clip_of, Index least) {
  SegmentMotion s{segment_of(clip_of(line), line, line.repeat ? 1 : least)};
  s.action = s.motion.frames();
  if (line.repeat) {
    detail::require_cycle(line, s.motion);
    s.cycle = Loop{0, s.motion.frames() - 1};
  } else if (line.hold) {
    s.motion = detail::with_last_pose(s.motion, static_cast<Index>(std::max(2.0, std::round(s.motion.fps / 2))));
    s.rest = Loop{s.action, s.motion.frames() - 1};
  } else if (!line.then.empty()) {
    const Motion next = clip_of(line.then.front());
    detail::require_cycle(line.then.front(), next);
    std::tie(s.motion, s.rest) = detail::with_rounds(s.motion, next);
  }
  s.motion = ground_recording(s.motion, line.seated);
  if (line.repeat) s.motion = off_treadmill(s.motion);
  return s;
}

MOTIONLANG_BODY Motion lasting(const SegmentMotion& segment, Index frames) {
  if (segment.rest && segment.motion.frames() >= frames)
    return crop(segment.motion, 0, std::max(frames, segment.action));
  const auto& loop = segment.rest ? segment.rest : segment.cycle;
  return loop && segment.motion.frames() < frames ? go_round(segment.motion, *loop, frames) : segment.motion;
}

MOTIONLANG_NAMESPACE_END
