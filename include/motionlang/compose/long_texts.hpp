// SPDX-License-Identifier: MIT
/// Divides long texts.
///
/// Denoisers learn from clips of ten seconds at most. If a text of a minute is one crop, the figure stands still or
/// turns in the air. In parts that follow each other, the action goes on all the time.
///
///     const auto motion = stmc.generate(divide_long_texts(timeline, 160), rng);
#pragma once

#include <vector>  // parts

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The limit for one text. A day in parts of 8 s makes 10,800.
inline constexpr Index most_parts = 100000;

namespace detail {

/// An interval as `count` parts that follow each other, whose lengths differ by at most one frame.
std::vector<Interval> equal_parts(const Interval& whole, Index count);

}  // namespace detail

/// Divides every text of more than `longest` frames into as few parts as possible, whose lengths differ by at most one
/// frame. Throws config_error 101 unless longest is 1 or more, and for more than most_parts of a text.
Timeline divide_long_texts(const Timeline& timeline, Index longest);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/long_texts.ipp>
#endif
