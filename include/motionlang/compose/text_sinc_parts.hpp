// SPDX-License-Identifier: MIT
/// The parts of SINC in a list or a text.
///
///     parse_sinc_parts("left arm, right arm");            // both arms
///     text_sinc_parts("a person waves", nullptr);         // guessed: arms
#pragma once

#include <optional>     // other texts
#include <string>       // texts
#include <string_view>  // lists

#include <motionlang/compose/body_part_answers.hpp>
#include <motionlang/kinematics/body_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The parts of a list with commas. None if the text is not such a list.
std::optional<SincParts> parse_sinc_parts(std::string_view list);

/// STMC's parts as SINC's. The legs become both legs and the pelvis that carries them; spine and head become the torso.
SincParts as_sinc_parts(const BodyParts& parts);

/// The parts of a list. For another text, those of the table, or without a table a guess (guess_body_parts). "": all.
/// Throws config_error 103 for a text that is not in the table.
SincParts text_sinc_parts(const std::string& text, const BodyPartTable* table);

/// "left arm, right arm"
std::string list_sinc_parts(const SincParts& parts);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/text_sinc_parts.ipp>
#endif
