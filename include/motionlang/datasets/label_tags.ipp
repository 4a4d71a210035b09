// SPDX-License-Identifier: MIT
// Bodies of label_tags.hpp.
#pragma once

#include <set>  // labels that are missing

#include <motionlang/datasets/humanml3d_texts.hpp>
#include <motionlang/datasets/label_tags.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY LabelTags::LabelTags(const FilePath& file) : file_(file.string()) {
  for (MotionCaption& c : read_captions(file)) words_.insert_or_assign(c.text, std::move(c.words));
}

MOTIONLANG_BODY void LabelTags::require(const std::vector<DescribedMotion>& motions) const {
  std::set<std::string> missing;
  for (const DescribedMotion& m : motions) {
    for (const DescribedText& t : m.texts) {
      if (!words_.contains(t.text)) missing.insert(t.text);
    }
  }
  if (missing.empty()) return;
  std::string lines;
  for (const std::string& label : missing) lines += "\n" + label;
  raise<config_error>(103, file_, ": no words of ", counted(missing.size(), "label"), ":", lines);
}

MOTIONLANG_BODY std::string LabelTags::join(std::span<const std::string> labels, Conjunction conjunction) const {
  if (labels.empty() || (conjunction != Conjunction::while_ && conjunction != Conjunction::during))
    return join_labels(labels, conjunction);
  return join_labels(labels, conjunction, [&](std::string_view) {
    std::vector<TaggedWord> words;
    for (const std::string& label : labels) {
      const auto own = words_.find(label);
      if (own == words_.end()) raise<config_error>(103, file_, ": no words of '", label, "'");
      if (!words.empty())
        words.push_back(conjunction == Conjunction::while_ ? TaggedWord{"while", "SCONJ"}
                                                           : TaggedWord{"during", "ADP"});
      words.insert(words.end(), own->second.begin(), own->second.end());
    }
    return words;
  });
}

MOTIONLANG_NAMESPACE_END
