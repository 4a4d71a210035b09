// SPDX-License-Identifier: MIT
/// Motions of timelines that several processes share: each makes those of a part of the list, and all get all of them,
/// with the bits of one process.
///
///     // In every process, with the same timelines and options.
///     const std::vector<Motion> motions = generate_motions(*model, timelines, {.seed = 7, .communicator = all});
///
/// The parts follow each other. They have about as much to make: the frames of all texts count.
/// Differs  a model whose motions depend on each other is refused (BatchMates), in all processes and before the work,
///          and so are files of noise and records
#pragma once

#include <functional>  // makers
#include <span>        // timelines
#include <vector>      // motions

#include <motionlang/compose/timeline.hpp>
#include <motionlang/generate/generate_options.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/train/messages.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Makes the motions of some timelines in one process.
using MotionMaker = std::function<std::vector<Motion>(std::span<const Timeline>, const GenerateOptions&)>;

/// The motions of all timelines, in all processes; the notes of the options as well.
/// make    is called once in each process that has a part, with `before` in its options
/// check   is called before in every process, once all are known to have the same list
/// Throws  config_error 102 if the timelines, the kernels, or the options that decide bits are not those of rank 0 in
///         some process; option_error 102 for files of noise and records; what `make` and `check` throw. Models are not
///         compared
std::vector<Motion> shared_motions(std::span<const Timeline> timelines, const GenerateOptions& options,
                                   const MotionMaker& make, const std::function<void()>& check = {});

/// The places in the list at which the parts of the ranks begin, and its end.
std::vector<Index> parts_of_timelines(std::span<const Timeline> timelines, Index ranks);

void put_motion(MessageWriter& out, const Motion& motion);
Motion take_motion(MessageReader& in);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/shared_motions.ipp>
#endif
