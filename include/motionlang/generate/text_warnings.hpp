// SPDX-License-Identifier: MIT
/// Warnings about texts that a model may not follow: texts far from all that it learned, unknown words, texts that are
/// too long, texts of several actions, and texts that other texts hide. The caller shows them.
///
///     for (const std::string& w : timeline_warnings(*model, timelines, options)) std::cerr << w << '\n';
#pragma once

#include <span>         // timelines
#include <string>       // sentences
#include <string_view>  // names
#include <vector>       // sentences

#include <motionlang/generate/motion_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The caller's own names for things in the warnings.
struct WarningNames {
  std::string_view source = "timeline";  // the source of the timelines: "walk.txt"
  std::string_view in_turn = "in_turn";  // the option that splits a text into its actions (compose/in_turn.hpp)
};

/// Warns about words of a text that the model does not know (text/known_words.hpp). Nothing if `known` is empty.
std::vector<std::string> unknown_word_warnings(const std::string& text, const KnownWords& known);
/// Warns about a text that is far from all captions, with the three nearest that say different words. A text that is
/// near is not warned about, whatever its words, and neither is one whose parts, joined by "and", "then" or "while",
/// are near. Unknown words of a text that is far are named. Nothing if there are no
/// captions.
std::vector<std::string> far_text_warnings(const std::string& text, const KnownCaptions& captions,
                                           const KnownWords& known);
/// Warns about a text if most motions that were tried for texts nearly like it did not do what they say.
std::vector<std::string> failing_text_warnings(const std::string& text, const KnownCaptions& captions);
/// Both kinds of warnings about the meaning of a text: far_text_warnings, and failing_text_warnings if it is near.
std::vector<std::string> meaning_warnings(const std::string& text, const KnownCaptions& captions,
                                          const KnownWords& known);
/// Warns about the meaning of a text, or about its words if the model does not have its captions. Also warns about more
/// word pieces than the model reads.
std::vector<std::string> text_warnings(const MotionModel& model, const std::string& text);

/// Warns about each text that has no effect at any time, because other texts take all of its parts. These have fewer
/// parts, or as many and come later in the file.
std::vector<std::string> hidden_text_warnings(std::span<const Timeline> timelines, const WarningNames& names = {});
/// Warns about each text whose words are about a few body parts (guess_body_parts), but which takes all parts from a
/// text that needs others.
std::vector<std::string> whole_body_warnings(std::span<const Timeline> timelines, const WarningNames& names = {});
/// Warns about each text of several actions (actions_in_turn).
std::vector<std::string> several_action_warnings(std::span<const Timeline> timelines, const WarningNames& names = {});
/// Warns about each text that cut_texts divides because it is too long.
std::vector<std::string> long_text_warnings(std::span<const Timeline> timelines, double fps);

/// Warns about each text that lasts much longer than its action, which ends (outlasts_action).
std::vector<std::string> outlasting_text_warnings(std::span<const Timeline> timelines, const KnownCaptions& captions,
                                                  double fps);

/// All five kinds, as far as they apply to the model and the options. There are none for a model without diffusion.
/// Several actions are reported only if the weights list the words, long texts only if texts are cut. Texts that
/// outlast their action are reported if the model has its captions, except those that cut_texts ends.
/// in_turn  true if the actions of the texts already follow each other
std::vector<std::string> timeline_warnings(const MotionModel& model, std::span<const Timeline> timelines,
                                           const GenerateOptions& options, bool in_turn = false,
                                           const WarningNames& names = {});

/// For each text of several actions, a note with the result of in_turn.
std::vector<std::string> in_turn_notes(std::span<const Timeline> timelines, double fps);

/// A note if the timeline of a text (text_timeline) consists of several texts.
std::vector<std::string> divided_text_notes(const std::string& text, const Timeline& timeline, double fps);

/// The body parts of a set, in the order of their names.
std::vector<BodyPart> listed_parts(BodyParts parts);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/text_warnings.ipp>
#endif
