// SPDX-License-Identifier: MIT
/// Texts in other encodings than UTF-8, which some programs write, as UTF-8.
#pragma once

#include <optional>     // other encodings
#include <string>       // output
#include <string_view>  // input

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A text in UTF-16 or UTF-32 as UTF-8, known by its byte order mark or by the zero bytes of its first two letters;
/// nothing if it is neither. Units without a character become U+FFFD.
std::optional<std::string> from_wide_text(std::string_view bytes);

/// A text of which each byte is one character, U+0000 to U+00FF (ISO 8859-1), as UTF-8.
std::string from_latin1(std::string_view bytes);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/text_encoding.ipp>
#endif
