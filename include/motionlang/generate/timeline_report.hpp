// SPDX-License-Identifier: MIT
/// A timeline for an editor, as JSON: its texts with their times and body parts, and the warnings about them.
///
///     timeline_report(*model, "walk forwad # 0 # 6 # legs\n")
///     {"fps": 20.0, "seconds": 6.0,
///      "texts": [{"text": "walk forwad", "start": 0.0, "end": 6.0, "parts": ["legs"]}],
///      "warnings": [{"texts": [0], "message": "'walk forwad': ..."}]}
#pragma once

#include <span>         // texts
#include <string>       // JSON
#include <string_view>  // timelines

#include <motionlang/generate/generate_options.hpp>
#include <motionlang/generate/motion_model.hpp>
#include <motionlang/text/text_completion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Times are those of the text, in seconds from the first start. A text for the whole body has the one part "whole
/// body". The warnings are those of text_warnings and timeline_warnings; `texts` has the numbers of the texts that a
/// warning is about, the first is 0.
/// Throws  timeline_error 501 ... 504, 507, 509
std::string timeline_report(const MotionModel& model, std::string_view text, const GenerateOptions& options = {});

/// Texts to offer to somebody who writes, as JSON: [{"text", "seconds", "repeats"}].
std::string known_texts_report(std::span<const KnownText> texts);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/timeline_report.ipp>
#endif
