// SPDX-License-Identifier: MIT
/// Long texts in parts.
///
/// Denoisers learn from clips of ten seconds at most. A text of a minute as one crop makes somebody who stands, or
/// turns in the air; in parts that follow each other it is done all the time.
///
///     const auto motion = stmc.generate(divide_long_texts(timeline, 160), rng);
#pragma once

#include <vector>  // parts

#include <motionlang/compose/timeline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The limit for one text: a day in parts of 8 s makes 10,800.
inline constexpr Index most_parts = 100000;

namespace detail {

/// An interval in `count` parts that follow each other, equally long to a frame.
std::vector<Interval> equal_parts(const Interval& whole, Index count);

}  // namespace detail

/// Divides every text of more than `longest` frames into as few parts as will do, which are equally long to a frame.
/// Throws config_error 101 unless longest is 1 or more, and for more than most_parts of a text.
Timeline divide_long_texts(const Timeline& timeline, Index longest);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/long_texts.ipp>
#endif
