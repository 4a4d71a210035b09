// SPDX-License-Identifier: MIT
// Bodies of description_evaluation.hpp.
#pragma once

#include <sstream>  // words

#include <motionlang/train/description_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY CommonTags::CommonTags(const std::vector<DescribedMotion>& motions) {
  std::map<std::string, std::map<std::string, Index>> counts;
  for (const DescribedMotion& m : motions) {
    for (const DescribedText& t : m.texts) {
      for (const TaggedWord& w : t.words) ++counts[w.word][w.tag];
    }
  }
  for (const auto& [word, of_tag] : counts) {
    Index most = 0;
    for (const auto& [tag, count] : of_tag) {
      if (count > most) most = count, tags_[word] = tag;
    }
  }
}

MOTIONLANG_BODY std::string CommonTags::tagged(const std::string& sentence) const {
  if (empty()) return sentence;
  std::istringstream words(sentence);
  std::string out;
  for (std::string word; words >> word;) {
    const auto found = tags_.find(word);
    out += (out.empty() ? "" : " ") + word + "/" + (found == tags_.end() ? "OTHER" : found->second);
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> CommonTags::tagged(std::span<const std::string> sentences) const {
  std::vector<std::string> out;
  for (const std::string& s : sentences) out.push_back(tagged(s));
  return out;
}

MOTIONLANG_NAMESPACE_END
