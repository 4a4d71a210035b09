// SPDX-License-Identifier: MIT
/// Converts texts in other encodings, which some programs write, to UTF-8.
#pragma once

#include <optional>     // other encodings
#include <string>       // output
#include <string_view>  // input

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A text in UTF-16 or UTF-32 as UTF-8. It is recognised by its byte order mark, or by the zero bytes of its first two
/// letters. Nothing if it is neither. Units without a character become U+FFFD.
std::optional<std::string> from_wide_text(std::string_view bytes);

/// A text with one byte per character, U+0000 to U+00FF (ISO 8859-1), as UTF-8.
std::string from_latin1(std::string_view bytes);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/text_encoding.ipp>
#endif
