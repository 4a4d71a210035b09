// SPDX-License-Identifier: MIT
/// Sentences about texts that a model may not do as they say: words that it never learned, texts that are too long for
/// it, that say several actions, or that other texts hide. The caller shows them.
///
///     for (const std::string& w : timeline_warnings(*model, timelines, options)) std::cerr << w << '\n';
#pragma once

#include <span>         // timelines
#include <string>       // sentences
#include <string_view>  // names
#include <vector>       // sentences

#include <motionlang/generate/motion_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// How sentences call what the caller knows by a name of its own.
struct WarningNames {
  std::string_view source = "timeline";  // where the timelines were read: "walk.txt"
  std::string_view in_turn = "in_turn";  // what makes the actions of a text one after the other (compose/in_turn.hpp)
};

/// About words of a text that the model does not know (text/known_words.hpp). Nothing if `known` is empty.
std::vector<std::string> unknown_word_warnings(const std::string& text, const std::vector<std::string>& known);
/// About a text, which is unknown words and a text of more word pieces than the model reads.
std::vector<std::string> text_warnings(const MotionModel& model, const std::string& text);

/// About each text that moves nothing at any time: others with fewer parts, or as many and later in the file, take all
/// that it has.
std::vector<std::string> hidden_text_warnings(std::span<const Timeline> timelines, const WarningNames& names = {});
/// About each text of a few body parts, as far as its words tell (guess_body_parts), that takes all of them from a text
/// that needs others.
std::vector<std::string> whole_body_warnings(std::span<const Timeline> timelines, const WarningNames& names = {});
/// About each text of several actions (actions_in_turn).
std::vector<std::string> several_action_warnings(std::span<const Timeline> timelines, const WarningNames& names = {});
/// About each text that cut_texts makes in parts because it is too long.
std::vector<std::string> long_text_warnings(std::span<const Timeline> timelines, double fps);

/// All four, as far as they concern the model and the options: none for a model that is not a diffusion model, several
/// actions only where the weights list the words, long texts only where texts are cut.
/// in_turn  whether the actions of the texts are already one after the other
std::vector<std::string> timeline_warnings(const MotionModel& model, std::span<const Timeline> timelines,
                                           const GenerateOptions& options, bool in_turn = false,
                                           const WarningNames& names = {});

/// About each text of several actions what in_turn makes of it.
std::vector<std::string> in_turn_notes(std::span<const Timeline> timelines, double fps);

/// The body parts of a set, in the order of their names.
std::vector<BodyPart> listed_parts(BodyParts parts);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/text_warnings.ipp>
#endif
