// SPDX-License-Identifier: MIT
/// The part of generate_motion about options and kept motions that does not depend on the backend.
#pragma once

#include <motionlang/features/layout.hpp>
#include <motionlang/generate/finish_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws option_error 105 if more steps are wanted than the model has.
void require_steps(const GenerateOptions& options, Index steps);
/// Throws option_error 102 for options of models that go through STMC that contradict each other.
void require_one_source(const GenerateOptions& options);

/// The frames that are kept of a clip of `frames` frames in a timeline of `wanted`. Throws option_error 101 for frames
/// that are not there.
std::vector<IndexRange> kept_frames(const KeptClip& keep, Index frames, Index wanted, double fps);

/// Made frames, at most this many beside those that are kept, lead from the ones to the others.
Motion without_jumps(Motion motion, std::span<const IndexRange> kept, Index frames);

/// Where the clip is, if its way is kept: turned and moved over the floor. Frames that are kept behind made ones are
/// where these lead.
/// clip  what is kept, at the rate of the motion
Motion in_its_place(Motion motion, const Motion& other, Index clip_frames, const GenerateOptions& options);

/// Metres over the floor that the root of any kept frame is from where it was; 0 where the way is not kept.
double farthest_from(const Motion& motion, const Motion& clip, Index clip_frames, const KeptClip& keep);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/detail/kept_clip.ipp>
#endif
