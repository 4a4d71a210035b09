// SPDX-License-Identifier: MIT
/// Cleans texts for the CLIP tokenizer: the deterministic steps of ftfy's repair, and HTML entities.
///
/// Source   openai/CLIP clip/simple_tokenizer.py basic_clean; ftfy 6.3.1 (Speer 2019); Python's html.unescape, HTML5's
///          rules
/// Differs  from ftfy: text that was decoded in the wrong encoding ("mojibake") does not change; the steps are repeated
///          at most 100 times
#pragma once

#include <motionlang/version.hpp>
#include <string>       // texts
#include <string_view>  // texts

MOTIONLANG_NAMESPACE_BEGIN

/// Replaces HTML entities as browsers do. Named ones may lack their semicolon if HTML allows that; the longest name
/// wins.
std::string html_unescape(std::string_view text);

/// Repairs a text: entities, C1 controls, ligatures, wide forms, curly quotes, line ends, terminal escapes, control
/// characters, NFC. Bytes that are not UTF-8 become U+FFFD.
std::string repair_text(std::string_view text);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/text_repair.ipp>
#endif
