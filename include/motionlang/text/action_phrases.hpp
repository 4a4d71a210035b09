// SPDX-License-Identifier: MIT
/// The action phrases of a caption: each verb with the words that belong to it, and how often a data set has each.
///
///     const std::vector<TaggedWord> words{{"a", "DET"}, {"man", "NOUN"}, {"walk", "VERB"}, {"slowly", "ADV"}};
///     const auto phrases = action_phrases(words);   // "walk slowly"
///
/// Source   thesis 4.3.1, the statistics of KIT-ML: 4153 phrases in 6352 captions
/// Differs  there a parser attaches the complements of a verb. Here they are the words after it, up to the next verb,
///          auxiliary, conjunction or punctuation mark, without articles and pronouns
#pragma once

#include <cstddef>  // counts
#include <map>      // counts
#include <span>     // words
#include <string>   // phrases
#include <vector>   // phrases

#include <motionlang/text/tagged_word.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// `words` are lemmas, as in the caption files of HumanML3D and KIT-ML. Verbs have the tag "VERB".
std::vector<std::string> action_phrases(std::span<const TaggedWord> words);

/// How often each phrase occurs.
struct PhraseCounts {
  std::map<std::string, std::size_t> times{};

  explicit PhraseCounts(std::span<const std::string> phrases);
  /// The number of phrases that occur fewer than `limit` times.
  std::size_t below(std::size_t limit) const;
  /// "4153 action phrases, 2.25 times on average; 'walk forward' most often, 596 times; 4030 less than ten times, 3226
  /// once". Empty if there are none.
  std::string text() const;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/action_phrases.ipp>
#endif
