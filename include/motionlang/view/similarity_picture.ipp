// SPDX-License-Identifier: MIT
// Bodies of similarity_picture.hpp.
#pragma once

#include <algorithm>  // max
#include <cmath>      // lround

#include <motionlang/core/formatted.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/search/text_similarity.hpp>
#include <motionlang/view/similarity_picture.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY SimilarityPicture similarity_picture(const SearchEncoder& encoder, std::span<const TextToLocate> texts,
                                                     const Motion& motion, double window) {
  SimilarityPicture out;
  const auto frames = std::max<Index>(1, std::lround(window * encoder.model().fps));
  for (const auto& [text, truth] : texts) {
    const SimilarityOverTime found = text_similarity(encoder, text, motion, frames);
    Curve curve{"similarity", {}, found.similarity};
    for (std::size_t f = 0; f < found.similarity.size(); ++f) curve.steps.push_back(static_cast<double>(f) / found.fps);
    const double best = static_cast<double>(found.best) / found.fps;
    CurvePanel panel{.title = text, .curves = {std::move(curve)}, .axis = "seconds"};
    if (truth) panel.shaded.push_back(*truth);
    panel.marks.push_back(best);
    out.panels.push_back(std::move(panel));
    out.about += formatted("%-40s %.2f s, similarity %.3f\n", printable(text).c_str(), best,
                           found.similarity[static_cast<std::size_t>(found.best)]);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
