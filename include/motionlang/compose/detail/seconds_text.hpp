// SPDX-License-Identifier: MIT
/// Times in seconds as they are written in timelines.
#pragma once

#include <optional>     // times
#include <string>       // output
#include <string_view>  // input

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A finite time in seconds, at most `latest_time`. Nothing if the text is not such a time.
std::optional<double> parse_seconds(std::string_view text);

/// Shortest decimal form, as Python prints a float: 5.5, 8.0, 1e-05, 1e+16.
void append_python_float(std::string& out, double x);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/detail/seconds_text.ipp>
#endif
