// SPDX-License-Identifier: MIT
/// The words of labels with their parts of speech. Sentences of several labels take their verbs from here, so that any
/// two labels can be joined in training, and "walk while wave" becomes "walk while waveing", as published.
///
///     const LabelTags tags("labels.txt");                                   // lines "wave#wave/VERB#0.0#0.0"
///     tags.join(std::vector<std::string>{"walk", "wave"}, Conjunction::while_);
///
/// Source   thesis B.2.2; SINC sinc/model/sinc.py gerund_augment
/// Differs  spaCy tags whole sentences there. Here a label has the same tags in every sentence
#pragma once

#include <map>     // words of labels
#include <span>    // labels
#include <string>  // labels
#include <vector>  // words

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/file/file_path.hpp>
#include <motionlang/text/joined_labels.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class LabelTags {
 public:
  /// Throws what read_captions throws.
  explicit LabelTags(const FilePath& file);

  /// Throws config_error 103, with the labels, if the file lacks labels of these motions.
  void require(const std::vector<DescribedMotion>& motions) const;
  /// As join_labels, with the -ing form of the second verb after "while" and "during". Throws config_error 103 for a
  /// label that the file lacks.
  std::string join(std::span<const std::string> labels, Conjunction conjunction) const;

 private:
  std::string file_;
  std::map<std::string, std::vector<TaggedWord>> words_;  // of labels
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/label_tags.ipp>
#endif
