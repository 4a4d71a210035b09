// SPDX-License-Identifier: MIT
/// Times in seconds as they are written in timelines.
#pragma once

#include <optional>     // times
#include <string>       // output
#include <string_view>  // input

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A time in seconds, finite and not beyond `latest_time`; nothing if the whole text is none.
std::optional<double> parse_seconds(std::string_view text);

/// Shortest decimal form, as Python prints a float: 5.5, 8.0, 1e-05, 1e+16.
void append_python_float(std::string& out, double x);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/detail/seconds_text.ipp>
#endif
