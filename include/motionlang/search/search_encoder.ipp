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
  return count == 1 ? vectors : mean_direction(vectors, width);
}

MOTIONLANG_BODY std::vector<float> encode_together(const SearchEncoder& encoder, std::span<const std::string> texts) {
  if (texts.empty()) raise<shape_error>(203, "encode_together: no texts");
  auto vectors = encoder.encode_texts(texts);
  return texts.size() == 1 ? vectors : mean_direction(vectors, encoder.model().width);
}

MOTIONLANG_BODY std::vector<float> encode_motion(const SearchEncoder& encoder, const Motion& motion) {
  return encode_clip(encoder, encoder.rows_of(motion));
}

MOTIONLANG_NAMESPACE_END
