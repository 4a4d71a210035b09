// SPDX-License-Identifier: MIT
// Bodies of text_similarity.hpp.
#pragma once

#include <algorithm>  // max_element

#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/search/text_similarity.hpp>
#include <motionlang/search/unit_rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY SimilarityOverTime text_similarity(const SearchEncoder& encoder, const std::string& text,
                                                   const Motion& motion, Index width) {
  const std::vector<float> rows = encoder.rows_of(motion);
  SimilarityOverTime out{.fps = encoder.model().fps, .windows = moment_windows(encoder.frames(rows), width)};
  if (out.windows.empty()) raise<numeric_error>(302, "text_similarity: motion '", motion.name, "' has no frames");
  const Index latent = encoder.model().width;
  const auto moments = unit_rows(encoder.encode_windows(rows, out.windows), latent),
             query = unit_rows(encoder.encode_texts(std::span(&text, 1)), latent);
  for (std::size_t w = 0; w < out.windows.size(); ++w) {
    double sum = 0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(latent); ++c)
      sum += static_cast<double>(query[c]) * static_cast<double>(moments[w * static_cast<std::size_t>(latent) + c]);
    out.similarity.push_back(sum);
  }
  out.best =
      static_cast<Index>(std::max_element(out.similarity.begin(), out.similarity.end()) - out.similarity.begin());
  return out;
}

MOTIONLANG_NAMESPACE_END
