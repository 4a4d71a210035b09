// SPDX-License-Identifier: MIT
/// Joins labels of simultaneous actions to one sentence, in the five ways of SINC.
///
///     join_labels(labels, Conjunction::same_time)   // "walk and wave at the same time"
///
/// `while_` and `during` put the second verb into its -ing form. This needs a tagger of parts of speech: a callable
/// sentence -> words with their tags. Without one the words do not change.
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

/// In the order in which training numbers them.
enum class Conjunction { while_, simultaneously, comma, same_time, during };

/// A tagger that knows no words: the sentence does not change.
struct NoTagger {};

/// Joins the words by single blanks, with "ing" after the second verb unless it ends so. As published, it is naive:
/// "run" becomes "runing". Words need their form in the sentence, not their lemma; verbs have the tag "VERB".
std::string second_verb_to_gerund(std::span<const TaggedWord> words);

namespace detail {

/// Without a tagger.
std::string sentence_of_labels(std::span<const std::string> labels, Conjunction conjunction);

}  // namespace detail

/// Without labels, an empty sentence.
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
