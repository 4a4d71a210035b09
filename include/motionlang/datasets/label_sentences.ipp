// SPDX-License-Identifier: MIT
// Bodies of label_sentences.hpp.
#pragma once

#include <set>      // sentences that are missing
#include <utility>  // move

#include <motionlang/datasets/babel_motions.hpp>
#include <motionlang/datasets/humanml3d_texts.hpp>
#include <motionlang/datasets/label_sentences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY LabelSentences::LabelSentences(Conjunction conjunction, std::filesystem::path tags)
    : conjunction_(conjunction), tags_(std::move(tags)) {
  if (tags_.empty()) return;
  if (!has_gerund(conjunction))
    raise<config_error>(102, tags_.string(), ": tagged sentences are for the conjunctions while and during");
  for (MotionCaption& c : read_captions(FilePath(tags_))) words_.emplace(c.text, std::move(c.words));
}

MOTIONLANG_BODY void LabelSentences::require(const std::vector<const DescribedMotion*>& motions) const {
  if (tags_.empty()) return;
  std::set<std::string> missing;
  for (const DescribedMotion* m : motions) {
    const std::string plain = join_labels(labels_of(*m), conjunction_);
    if (!words_.contains(plain)) missing.insert(plain);
  }
  if (missing.empty()) return;
  std::string lines;
  for (const std::string& s : missing) lines += "\n" + s;
  raise<config_error>(103, tags_.string(), ": no words of ", counted(missing.size(), "sentence"), ":", lines);
}

MOTIONLANG_BODY std::string LabelSentences::operator()(std::span<const std::string> labels) const {
  if (tags_.empty()) return join_labels(labels, conjunction_);
  return join_labels(labels, conjunction_, [&](std::string_view plain) {
    const auto words = words_.find(std::string(plain));
    if (words == words_.end()) raise<config_error>(103, tags_.string(), ": no words of '", plain, "'");
    return words->second;
  });
}

MOTIONLANG_NAMESPACE_END
