// SPDX-License-Identifier: MIT
/// The parts of SINC that somebody wrote down, or that a text is about.
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

/// The parts that a list with commas names; none if it is something else.
std::optional<SincParts> parse_sinc_parts(std::string_view list);

/// STMC's parts as SINC's: the legs are both, with the pelvis, which carries them; spine and head are the torso.
SincParts as_sinc_parts(const BodyParts& parts);

/// The parts that a list names; of another text those of the table, or without one guessed (guess_body_parts). "": all.
/// Throws config_error 103 for a text that is not in the table.
SincParts text_sinc_parts(const std::string& text, const BodyPartTable* table);

/// "left arm, right arm"
std::string list_sinc_parts(const SincParts& parts);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/text_sinc_parts.ipp>
#endif
