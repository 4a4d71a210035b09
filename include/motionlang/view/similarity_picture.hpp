// SPDX-License-Identifier: MIT
/// The similarity of texts and a motion over time as curves, with the best moment of each text.
///
///     const auto picture = similarity_picture(tmr, texts, motion, 1.0);
///     write_file("moments.svg", curves_svg(picture.panels));
///
/// Source  TMR (Petrovich, Black, Varol, ICCV 2023), section 4.4; thesis figures 5.8 and 5.9
#pragma once

#include <optional>  // what is known
#include <span>      // texts
#include <string>    // texts
#include <utility>   // ranges of time
#include <vector>    // panels

#include <motionlang/search/search_encoder.hpp>
#include <motionlang/view/loss_curves.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A text, and the seconds in which the motion shows it, if they are known.
struct TextToLocate {
  std::string text;
  std::optional<std::pair<double, double>> truth{};
};

struct SimilarityPicture {
  std::vector<CurvePanel> panels;  // of each text: a curve over the seconds, the truth shaded, and a mark at the best
  std::string about;               // a line for each text: the best second and its similarity
};

/// window  seconds around each frame that are compared; at least one frame
/// Throws  what text_similarity throws
SimilarityPicture similarity_picture(const SearchEncoder& encoder, std::span<const TextToLocate> texts,
                                     const Motion& motion, double window);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/similarity_picture.ipp>
#endif
