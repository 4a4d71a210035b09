// SPDX-License-Identifier: MIT
/// Joins labels of simultaneous actions to sentences. If a file marks the verbs among their words, the second verb gets
/// its -ing form, as in the paper of SINC.
///
///     const LabelSentences sentence_of(Conjunction::while_, "tags.txt");
///     sentence_of(std::vector<std::string>{"walk", "wave"});                      // "walk while waving"
///
/// Source   thesis B.2.2; SINC sinc/model/sinc.py gerund_augment
/// Differs  Words are tagged in advance, by spaCy, in a file of captions in HumanML3D's form
#pragma once

#include <filesystem>  // file of words
#include <map>         // words of sentences
#include <span>        // labels
#include <string>      // sentences
#include <vector>      // words

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/text/joined_labels.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True if sentences of this kind have an -ing form: those with "while" and "during".
constexpr bool has_gerund(Conjunction c) { return c == Conjunction::while_ || c == Conjunction::during; }

class LabelSentences {
 public:
  /// tags    lines "walk while wave#walk/VERB while/SCONJ wave/VERB#0.0#0.0"; "": words stay as they are
  /// Throws  config_error 102 for a file where has_gerund is false, and what read_captions throws
  explicit LabelSentences(Conjunction conjunction, std::filesystem::path tags = {});

  /// Throws config_error 103, with the sentences, if the file lacks sentences of these motions.
  void require(const std::vector<const DescribedMotion*>& motions) const;
  /// Throws config_error 103 for a sentence that the file lacks; `require` finds them in advance.
  std::string operator()(std::span<const std::string> labels) const;

  Conjunction conjunction() const { return conjunction_; }
  bool has_tags() const { return !tags_.empty(); }

 private:
  Conjunction conjunction_;
  std::filesystem::path tags_;
  std::map<std::string, std::vector<TaggedWord>> words_;  // of sentences
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/label_sentences.ipp>
#endif
