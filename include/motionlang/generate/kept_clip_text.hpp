// SPDX-License-Identifier: MIT
/// The times and body parts of a KeptClip, as people write them, and its motion from a part of a longer one.
///
///     const KeptClip keep{
///         .motion = clip, .seconds = {parse_kept_range("0-1.5")}, .parts = parse_kept_parts("legs,head")};
#pragma once

#include <string_view>  // input
#include <utility>      // pairs of times

#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// From "0-1.5" to (0, 1.5). Throws option_error 101.
std::pair<double, double> parse_kept_range(std::string_view range);

/// Body parts, with commas between their names. Throws option_error 103.
BodyParts parse_kept_parts(std::string_view names);

/// The frames of a motion between two of its times in seconds, as far as it has them. The first one is at `start`, and
/// stands until then. Throws what frame_at, crop and delayed throw.
Motion kept_part(const Motion& motion, double from, double to, double start);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/kept_clip_text.ipp>
#endif
