// SPDX-License-Identifier: MIT
/// Edits clips: crop, resample, change speed, join, mirror, and remove the T-pose at the start of CMU files. The
/// functions do not change their argument.
#pragma once

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Frames first ... last - 1. Throws shape_error 203 unless 0 <= first <= last <= frames.
Motion crop(const Motion& motion, Index first, Index last);

/// The clip at another frame rate. Frame i shows the time i / fps, up to the end of the clip (its last frame is at
/// (frames - 1) / old fps). Root positions are interpolated linearly, rotations along the shortest arc. Times that
/// coincide with a frame take it unchanged, so going up by a whole factor and down again gives the same clip. Throws
/// config_error 101 unless fps > 0, and for more than max_rotations.
Motion resample(const Motion& motion, double fps);

/// The clip `factor` times as fast at the same frame rate (0.5: slow motion). Throws config_error 101 unless factor >
/// 0, and for more than max_rotations.
Motion change_speed(const Motion& motion, double factor);

namespace detail {

/// Throws config_error 102 unless both clips have one skeleton and one frame rate.
void require_same_kind(std::string_view function, const Motion& first, const Motion& second);

}  // namespace detail

/// `second` after `first`, without blending or alignment (see blend.hpp). Throws config_error 102 if skeletons or frame
/// rates differ.
Motion concatenate(const Motion& first, const Motion& second);

/// For each joint its partner on the other side, found by name; a joint in the middle is its own partner.
/// Throws config_error 103 if a name says "left" or "right" and its partner is missing.
std::vector<int> mirror_partners(const Skeleton& skeleton);

/// The clip mirrored at the sagittal plane x = 0: left becomes right.
///    p'_partner(j) = (-x, y, z)_j,   q'_partner(j) = (w, x, -y, -z)_j
/// The skeleton is mirrored, too, so that positions are exact images for any local axes; a symmetric one does not
/// change. Throws config_error 102 if the partners do not pair up or their parents are not partners.
Motion mirror(const Motion& motion, std::span<const int> partners);
/// The same with the partners that the names of the joints give.
inline Motion mirror(const Motion& motion) { return mirror(motion, mirror_partners(motion.skeleton)); }

/// The number of frames at the start that are an inserted T-pose, not performed. Exporters put the zero pose before CMU
/// trials, and some blend out of it (Daz files, with a spline that swings over for the same time).
/// The first pose must be the zero pose (5 degrees in the mean over the joints), and the clip must leave it far faster
/// than it moves afterwards. A performer who really starts in a T-pose is not affected. A pose that repeats exactly
/// counts as one frame. Returns 0 for skeletons whose zero pose is not a T-pose, so call it before retargeting.
Index detect_t_pose_lead_in(const Motion& motion);

/// The clip without those frames.
inline Motion drop_lead_in(const Motion& motion) {
  return crop(motion, detect_t_pose_lead_in(motion), motion.frames());
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/motion_tools.ipp>
#endif
