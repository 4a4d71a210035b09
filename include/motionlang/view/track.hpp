// SPDX-License-Identifier: MIT
/// A row of a timeline as pictures show it: a text, its times, and its parts of the body.
#pragma once

#include <span>    // tracks
#include <string>  // text
#include <vector>  // parts

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The name of all parts together.
inline constexpr const char* whole_body = "whole body";

struct Track {
  std::string text;
  double start = 0, end = 0;         // seconds
  std::vector<std::string> parts{};  // names of body parts; empty, or only whole_body: all of them
};

namespace detail {

void require_finite_times(const char* who, std::span<const Track> tracks);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/track.ipp>
#endif
