// SPDX-License-Identifier: MIT
/// Words and verbs of the texts of a data set, to compare data sets.
///
/// Source  TEACH (thesis annex A), figure A.3: tokens that appear at least n times, and texts with each verb
/// Differs there a tagger finds the verbs. Here verbs are those of a list, in any of their forms
#pragma once

#include <cstddef>      // counts
#include <filesystem>   // files
#include <map>          // counts
#include <span>         // texts
#include <string>       // words
#include <string_view>  // words
#include <vector>       // texts

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The texts of a data set, and their action phrases where words have parts of speech.
struct DataTexts {
  std::vector<std::string> texts, phrases;
};
/// All texts of a table of captions, of a .json file of annotations or of BABEL, or of a folder as HumanML3D has it.
/// Such a folder has parts of speech. It is read by all.txt, or by train.txt, val.txt and test.txt. A mirrored clip
/// (M000012) whose original is listed is left out, since its texts are the same. Throws what the readers throw.
DataTexts texts_of_data(const std::filesystem::path& path);

/// How often each word occurs; words are in lower case, without punctuation.
std::map<std::string, std::size_t> word_counts(std::span<const std::string> texts);
/// The number of words that occur at least `least` times.
std::size_t words_at_least(const std::map<std::string, std::size_t>& counts, std::size_t least);

/// The verbs with which texts command: "walk" of "walk along" (datasets/caption_card.hpp).
std::vector<std::string> commanded_verbs(std::span<const std::string> texts);
/// The number of texts with each of the verbs, in any form that text/word_forms.hpp knows. Verbs without a text are
/// left out.
std::map<std::string, std::size_t> verb_counts(std::span<const std::string> texts, std::span<const std::string> verbs);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/word_counts.ipp>
#endif
