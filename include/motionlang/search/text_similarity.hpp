// SPDX-License-Identifier: MIT
/// The similarity of a text and a motion over time: the text against a window around each frame.
///
///     const auto over_time = text_similarity(tmr, "a person sits down", motion, 20);
///
/// Source  TMR (Petrovich, Black, Varol, ICCV 2023), section 4.4; thesis figures 5.8 and 5.9: windows of 20 frames, at
///         20 frames per second
#pragma once

#include <span>    // rows
#include <string>  // text
#include <vector>  // similarities

#include <motionlang/search/search_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct SimilarityOverTime {
  double fps = 0;                     // of the model
  std::vector<FrameSlice> windows{};  // one around each frame (metrics/retrieval.hpp)
  std::vector<double> similarity{};   // cosine, of each frame
  Index best = 0;                     // the first frame with the largest
};

/// width   frames of a window
/// Throws  config_error 101 for a width below 1; numeric_error 302 for a motion without frames; what the encoder throws
SimilarityOverTime text_similarity(const SearchEncoder& encoder, const std::string& text, const Motion& motion,
                                   Index width);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/text_similarity.ipp>
#endif
