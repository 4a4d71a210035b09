// SPDX-License-Identifier: MIT
/// Questions to a language model about the body parts of an action. body_part_answers.hpp reads its answers.
///
///     body_part_prompt("wave", BodyPartPrompt::few_shot)
///
/// Source   thesis B.2.1, table B.1: (a) free form, (b) choose from a list, (c) list and examples; SINC (Athanasiou et
///          al., ICCV 2023) asks (c) of text-davinci-003 at temperature 0, at most 256 tokens
/// Differs  the thesis states the instruction and the questions of (b) and (c) in parts; the words between are ours
#pragma once

#include <string>  // prompts

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// In the order of table B.1.
enum class BodyPartPrompt { free_form, list, few_shot };

std::string body_part_prompt(const std::string& action, BodyPartPrompt form = BodyPartPrompt::few_shot);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/body_part_prompts.ipp>
#endif
