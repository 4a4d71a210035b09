// SPDX-License-Identifier: MIT
/// Text and numbers as they stand in SVG and HTML.
#pragma once

#include <string>       // output
#include <string_view>  // input

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Escapes UTF-8 so that nothing in it is markup: & < > " ' become entities; bytes that are not UTF-8 and characters
/// that XML forbids become U+FFFD.
std::string escape_markup(std::string_view text);

/// A number with a fixed count of decimals, without zeros at the end.
std::string fixed(double value, int decimals = 1);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/detail/markup.ipp>
#endif
