// SPDX-License-Identifier: MIT
/// The meaning of a cosine between a text and a motion: the share of unlike pairs that are farther apart, and the
/// cosine from which a motion shows the text.
///
///     const SimilarityScale scale = similarity_scale(unlike, own, strangers);
///     share_below(scale, 0.7);        // 0.992: of 1000 pairs of a text and another motion, 992 have a lower cosine
///     is_shown(scale, 0.7);           // true
#pragma once

#include <span>    // cosines
#include <vector>  // cosines

#include <motionlang/core/concepts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct SimilarityScale {
  static constexpr bool is_option = true;  // holds no tensors

  std::vector<double> shares{}, cosines{};    // ascending: of unlike pairs, this share is below this cosine
  double least = -1;                          // cosine; a text whose best motion is below is shown by none
  double missed = 0;                          // share of texts whose own motion is below `least`
  double fooled = 0;                          // share of texts without a motion whose best is not below
  Index pairs = 0, texts = 0, strangers = 0;  // how many were measured

  bool empty() const { return cosines.empty(); }
  bool operator==(const SimilarityScale&) const = default;
};

/// unlike     cosines of texts with motions that do not show them
/// own        cosines of texts with their motions
/// strangers  for each of some texts that no motion shows: the cosine of the nearest motion
/// `least` is where the larger of both errors is smallest; -1 if that is half or more, or without strangers or texts.
/// Throws  config_error 101 if `unlike` is empty, numeric_error 301 for a cosine that is not finite
SimilarityScale similarity_scale(std::span<const float> unlike, std::span<const float> own,
                                 std::span<const float> strangers);

/// The share of unlike pairs below this cosine, from 0 to 0.9999. It never says more than that one of the pairs is
/// above. Throws config_error 101 for an empty scale, numeric_error 301 for a cosine that is not finite.
double share_below(const SimilarityScale& scale, double cosine);

/// False if texts that no motion shows also reach this cosine. Always true for an empty scale.
inline bool is_shown(const SimilarityScale& scale, double cosine) { return scale.empty() || cosine >= scale.least; }

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/similarity_scale.ipp>
#endif
