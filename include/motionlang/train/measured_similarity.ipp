// SPDX-License-Identifier: MIT
// Bodies of measured_similarity.hpp.
#pragma once

#include <algorithm>  // clamp, max

#include <motionlang/search/unit_rows.hpp>
#include <motionlang/train/measured_similarity.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline float dot_product(std::span<const float> a, std::span<const float> b) {
  float sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}
inline std::span<const float> row_of(std::span<const float> rows, Index row, Index width) {
  return rows.subspan(static_cast<std::size_t>(row * width), static_cast<std::size_t>(width));
}

MOTIONLANG_BODY std::vector<Index> spread_numbers(Index count, Index most) {
  std::vector<Index> out;
  const Index taken = std::clamp<Index>(most, 0, count);
  for (Index i = 0; i < taken; ++i) out.push_back(i * count / taken);
  return out;
}

MOTIONLANG_BODY std::vector<float> unit_latents(std::span<const float> rows, Index width) {
  return rows.empty() ? std::vector<float>() : unit_rows(rows, width);
}

MOTIONLANG_BODY SimilarityScale scale_of_latents(const MeasuredTexts& texts, std::span<const float> text_rows,
                                                 std::span<const float> motion_rows,
                                                 std::span<const float> stranger_rows, Index width,
                                                 const std::vector<std::string>& clips,
                                                 const std::vector<std::string>& motion_texts,
                                                 const EmbeddingCache& sentences, double unlike) {
  std::vector<std::span<const float>> said;
  said.reserve(motion_texts.size());
  for (const std::string& t : motion_texts) said.push_back(sentences.find(t));
  std::vector<float> of_unlike, own, nearest;
  const Index motions = std::ssize(clips);
  for (std::size_t t = 0; t < texts.texts.size(); ++t) {
    const auto text = row_of(text_rows, static_cast<Index>(t), width);
    const Index shown = texts.motions[t];
    own.push_back(dot_product(text, row_of(motion_rows, shown, width)));
    const auto sentence = sentences.find(texts.texts[t]);
    for (Index m = 0; m < motions; ++m) {
      if (clips[static_cast<std::size_t>(m)] == clips[static_cast<std::size_t>(shown)]) continue;
      if (static_cast<double>(dot_product(sentence, said[static_cast<std::size_t>(m)])) > unlike) continue;
      of_unlike.push_back(dot_product(text, row_of(motion_rows, m, width)));
    }
  }
  for (Index s = 0; s < std::ssize(stranger_rows) / width; ++s) {
    float best = -1;
    for (Index m = 0; m < motions; ++m)
      best = std::max(best, dot_product(row_of(stranger_rows, s, width), row_of(motion_rows, m, width)));
    nearest.push_back(best);
  }
  return of_unlike.empty() ? SimilarityScale() : similarity_scale(of_unlike, own, nearest);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
