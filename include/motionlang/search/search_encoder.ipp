// SPDX-License-Identifier: MIT
// Bodies of search_encoder.hpp.
#pragma once

#include <algorithm>  // max
#include <cmath>      // lround

#include <motionlang/search/search_encoder.hpp>
#include <motionlang/search/unit_rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY const SimilarityScale& SearchEncoder::similarity() const {
  static const SimilarityScale none;
  return none;
}

MOTIONLANG_BODY std::vector<float> encode_clip(const SearchEncoder& encoder, std::span<const float> rows) {
  const Index width = encoder.model().width, all = encoder.frames(rows),
              longest = std::max<Index>(1, std::lround(10 * encoder.model().fps)),
              count = (all + longest - 1) / longest;
  std::vector<FrameSlice> stretches;
  for (Index i = 0; i < count; ++i) {
    const Index first = all * i / count;
    stretches.push_back({first, all * (i + 1) / count - first});
  }
  auto vectors = encoder.encode_windows(rows, stretches);
  if (count == 1) return vectors;
  vectors = unit_rows(vectors, width);
  std::vector<float> mean(static_cast<std::size_t>(width));
  for (std::size_t i = 0; i < vectors.size(); ++i) mean[i % mean.size()] += vectors[i] / static_cast<float>(count);
  return mean;
}

MOTIONLANG_BODY std::vector<float> encode_motion(const SearchEncoder& encoder, const Motion& motion) {
  return encode_clip(encoder, encoder.rows_of(motion));
}

MOTIONLANG_NAMESPACE_END
