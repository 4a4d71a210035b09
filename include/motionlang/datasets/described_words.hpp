// SPDX-License-Identifier: MIT
/// The words of described motions for TM2T.
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <motionlang/core/rng.hpp>
#include <motionlang/text/glove.hpp>

#include <motionlang/datasets/described_motions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Lemmas of a text: those of the data set, otherwise approximate ones.
inline std::vector<TaggedWord> words_of(const DescribedText& text, const GloVe& words) {
  return text.words.empty() ? words.tokens(text.text) : text.words;
}
/// The words of all training texts, after the marks, with random vectors.
inline GloVe words_of(const DescribedMotions& data, Index width, Philox rng) {
  const std::vector<std::string> marks{"sos", "eos", "unk"};
  const GloVe none(marks, std::vector<float>(3), 1);
  std::set<std::string> found;
  for (const DescribedMotion& m : data.training) {
    for (const DescribedText& t : m.texts) {
      for (const TaggedWord& w : words_of(t, none)) found.insert(w.word);
    }
  }
  std::vector<std::string> all = marks;
  for (const std::string& word : found) {
    if (std::find(marks.begin(), marks.end(), word) == marks.end()) all.push_back(word);
  }
  std::vector<float> vectors(all.size() * static_cast<std::size_t>(width));
  rng.normal<float>(vectors);
  return {all, std::move(vectors), width};
}

MOTIONLANG_NAMESPACE_END
