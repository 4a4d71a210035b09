// SPDX-License-Identifier: MIT
/// Mean and standard deviation of every feature over many clips, one frame at a time.
///
///     n_k = n_{k-1} + 1,  d = x - mean,  mean += d / n,  m2 += d (x - mean);   std = sqrt(m2 / (n - 1))
///
/// Source  Welford, "Note on a method for calculating corrected sums of squares" (Technometrics 1962). The published
///         scripts (TEMOS, TMR) concatenate all clips and take torch's unbiased deviation, which is the same up to
///         rounding. HumanML3D takes the deviation of the population, with n instead of n - 1, and skips clips with
///         NaN. It replaces each deviation by the mean of its group (HumanML3D cal_mean_variance.ipynb):
///
///     for (const auto& clip : clips) statistics.add_finite(std::span<const float>(clip), slots.size());
///     auto std = group_means(statistics.population_deviation(), slots.groups());
#pragma once

#include <algorithm>  // all_of, fill
#include <cmath>      // sqrt
#include <span>       // frames
#include <vector>     // sums

#include <motionlang/features/layout.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class FeatureStatistics {
 public:
  /// Adds the frames of a clip, (frames, features) row by row. Throws shape_error 205 if the values are not whole
  /// frames, and 204 if earlier clips had another number of features.
  template <Scalar S>
  void add(std::span<const S> frames, Index features) {
    if (features <= 0 || std::ssize(frames) % features != 0) {
      raise<shape_error>(205, "FeatureStatistics: ", frames.size(), " values in frames of ", features);
    }
    if (mean_.empty()) {
      mean_.resize(static_cast<std::size_t>(features));
      squares_.resize(static_cast<std::size_t>(features));
    }
    if (std::ssize(mean_) != features) {
      raise<shape_error>(204, "FeatureStatistics: ", features, " features after ", mean_.size());
    }
    for (std::size_t at = 0; at < frames.size(); at += mean_.size()) {
      ++count_;
      for (std::size_t i = 0; i < mean_.size(); ++i) {
        const double x = static_cast<double>(frames[at + i]), d = x - mean_[i];
        mean_[i] += d / static_cast<double>(count_);
        squares_[i] += d * (x - mean_[i]);
      }
    }
  }

  /// The same, but skips a clip with a value that is not finite. Returns true if the clip was added.
  template <Scalar S>
  bool add_finite(std::span<const S> frames, Index features) {
    const bool finite = std::all_of(frames.begin(), frames.end(), [](S x) { return std::isfinite(x); });
    if (finite) add(frames, features);
    return finite;
  }

  /// Number of frames so far.
  Index count() const { return count_; }
  const std::vector<double>& mean() const { return mean_; }
  /// Unbiased (divided by n - 1). Throws numeric_error 302 below two frames.
  std::vector<double> standard_deviation() const { return deviation(2); }
  /// The deviation of these frames themselves (divided by n). Throws numeric_error 302 without a frame.
  std::vector<double> population_deviation() const { return deviation(1); }

 private:
  std::vector<double> deviation(Index least) const;

  Index count_ = 0;
  std::vector<double> mean_, squares_;
};

/// Replaces every value by the mean of its group. Throws shape_error 203 if a group is empty or ends after the values.
std::vector<double> group_means(std::vector<double> values, std::span<const IndexRange> groups);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/features/statistics.ipp>
#endif
