// SPDX-License-Identifier: MIT
/// The part of generate_motion about options and kept motions that does not depend on the backend.
#pragma once

#include <motionlang/features/layout.hpp>
#include <motionlang/generate/finish_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws option_error 105 if the options ask for more steps than the model has.
void require_steps(const GenerateOptions& options, Index steps);
/// Throws option_error 102 for contradictory options of models that go through STMC.
void require_one_source(const GenerateOptions& options);
/// Throws option_error 102 for options whose files are about the whole list of timelines.
void require_no_list_files(const GenerateOptions& options);

/// The frames to keep of a clip of `frames` frames in a timeline of `wanted` frames. Throws option_error 101 for frames
/// that do not exist.
std::vector<IndexRange> kept_frames(const KeptClip& keep, Index frames, Index wanted, double fps);

/// Blends at most this many generated frames beside the kept ones, so that they lead from one to the other.
Motion without_jumps(Motion motion, std::span<const IndexRange> kept, Index frames);

/// Moves and turns the motion over the floor so that the clip is in its place, if its path is kept. Kept frames after
/// generated ones are where these lead.
/// clip  the kept motion, at the rate of the motion
Motion in_its_place(Motion motion, const Motion& other, Index clip_frames, const GenerateOptions& options);

/// The largest distance over the floor, in metres, of the root of a kept frame from its old place. 0 if the path is not
/// kept.
double farthest_from(const Motion& motion, const Motion& clip, Index clip_frames, const KeptClip& keep);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/detail/kept_clip.ipp>
#endif
