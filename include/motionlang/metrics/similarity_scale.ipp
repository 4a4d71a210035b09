// SPDX-License-Identifier: MIT
// Bodies of similarity_scale.hpp.
#pragma once

#include <algorithm>  // sort, lower_bound
#include <cmath>      // isfinite
#include <limits>     // infinity

#include <motionlang/core/error.hpp>
#include <motionlang/metrics/similarity_scale.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline std::vector<double> sorted_cosines(std::span<const float> cosines, const char* what) {
  std::vector<double> out(cosines.begin(), cosines.end());
  for (const double x : out) {
    if (!std::isfinite(x)) raise<numeric_error>(301, "similarity_scale: a cosine of ", what, " is ", x);
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// The share of sorted values below x.
inline double share_of_sorted(const std::vector<double>& sorted, double x) {
  const auto below = std::lower_bound(sorted.begin(), sorted.end(), x) - sorted.begin();
  return static_cast<double>(below) / static_cast<double>(sorted.size());
}

}  // namespace detail

MOTIONLANG_BODY SimilarityScale similarity_scale(std::span<const float> unlike, std::span<const float> own,
                                                 std::span<const float> strangers) {
  if (unlike.empty()) raise<config_error>(101, "similarity_scale: no unlike pairs");
  const auto pairs = detail::sorted_cosines(unlike, "unlike pairs"), texts = detail::sorted_cosines(own, "texts"),
             others = detail::sorted_cosines(strangers, "strangers");
  SimilarityScale out{.pairs = std::ssize(unlike), .texts = std::ssize(own), .strangers = std::ssize(strangers)};
  for (int percent = 0; percent < 100; ++percent) out.shares.push_back(percent / 100.0);
  for (const double share : {0.995, 0.998, 0.999, 0.9995, 0.9998, 0.9999}) out.shares.push_back(share);
  for (const double share : out.shares) {
    const auto rank = static_cast<std::size_t>(share * static_cast<double>(pairs.size()));
    out.cosines.push_back(pairs[std::min(rank, pairs.size() - 1)]);
  }
  if (texts.empty() || others.empty()) return out;
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto* candidates : {&texts, &others}) {
    for (const double least : *candidates) {
      const double missed = detail::share_of_sorted(texts, least), fooled = 1 - detail::share_of_sorted(others, least),
                   larger = std::max(missed, fooled);
      if (larger < smallest || (larger == smallest && least < out.least))
        smallest = larger, out.least = least, out.missed = missed, out.fooled = fooled;
    }
  }
  constexpr double useless = 0.5;  // the model cannot tell texts without a motion from others
  if (smallest >= useless) out.least = -1, out.missed = 0, out.fooled = 1;
  return out;
}

MOTIONLANG_BODY double share_below(const SimilarityScale& scale, double cosine) {
  const auto &x = scale.cosines, &y = scale.shares;
  if (x.empty() || x.size() != y.size()) raise<config_error>(101, "share_below: the scale has no cosines");
  if (!std::isfinite(cosine)) raise<numeric_error>(301, "share_below: the cosine is ", cosine);
  const auto above = std::upper_bound(x.begin(), x.end(), cosine);
  if (above == x.begin()) return 0;
  const auto i = static_cast<std::size_t>(above - x.begin());
  const double most = scale.pairs > 0 ? 1 - 1 / static_cast<double>(scale.pairs) : 1;
  if (i == x.size()) return std::min(y.back(), most);
  return std::min(most, y[i - 1] + (y[i] - y[i - 1]) * (cosine - x[i - 1]) / (x[i] - x[i - 1]));
}

MOTIONLANG_NAMESPACE_END
