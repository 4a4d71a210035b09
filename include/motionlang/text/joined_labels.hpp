// SPDX-License-Identifier: MIT
/// One sentence out of the labels of actions that happen at once, in the five ways of SINC.
///
///     join_labels(labels, Conjunction::same_time)   // "walk and wave at the same time"
///
/// `while_` and `during` put the second verb into its -ing form, for which a tagger of parts of speech is needed: a
/// callable sentence -> words with their tags. Without one the words stay as they are.
///
/// Source   thesis B.2.2; SINC sinc/model/sinc.py rule_based_concat, gerund_augment
/// Differs  the paper's evaluation says "while", its code "and ... at the same time"
#pragma once

#include <span>         // labels
#include <string_view>  // sentences
#include <type_traits>  // whether there is a tagger
#include <vector>       // words

#include <motionlang/text/tagged_word.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// In the order in which training draws them.
enum class Conjunction { while_, simultaneously, comma, same_time, during };

/// A tagger that knows no words: the sentence stays as it is.
struct NoTagger {};

/// The words joined by single blanks, "ing" after the second verb unless it ends so. Naive as published: "run" becomes
/// "runing". Of a word its form in the sentence is wanted, not its lemma; verbs have the tag "VERB".
std::string second_verb_to_gerund(std::span<const TaggedWord> words);

namespace detail {

/// Without a tagger.
std::string sentence_of_labels(std::span<const std::string> labels, Conjunction conjunction);

}  // namespace detail

/// No label: an empty sentence.
template <class Tagger = NoTagger>
std::string join_labels(std::span<const std::string> labels, Conjunction conjunction, Tagger&& tagger = {}) {
  std::string out = detail::sentence_of_labels(labels, conjunction);
  if constexpr (!std::is_same_v<std::remove_cvref_t<Tagger>, NoTagger>) {
    if (!labels.empty() && (conjunction == Conjunction::while_ || conjunction == Conjunction::during)) {
      const std::vector<TaggedWord> words = tagger(std::string_view(out));
      return second_verb_to_gerund(words);
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/joined_labels.ipp>
#endif
