// SPDX-License-Identifier: MIT
/// Mean and standard deviation of every feature over many clips, one frame at a time.
///
///     n_k = n_{k-1} + 1,  d = x - mean,  mean += d / n,  m2 += d (x - mean);   std = sqrt(m2 / (n - 1))
///
/// Source  Welford, "Note on a method for calculating corrected sums of squares" (Technometrics 1962). The published
///         scripts (TEMOS, TMR) concatenate all clips and take torch's unbiased deviation: the same up to rounding.
#pragma once

#include <cmath>   // sqrt
#include <span>    // frames
#include <vector>  // sums

#include <motionlang/core/concepts.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

class FeatureStatistics {
 public:
  /// Adds the frames of a clip, (frames, features) row by row. Throws shape_error 205 if the values are not whole
  /// frames, 204 if the clips before had another number of features.
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

  /// Frames so far.
  Index count() const { return count_; }
  const std::vector<double>& mean() const { return mean_; }
  /// Unbiased (divided by n - 1). Throws numeric_error 302 below two frames.
  std::vector<double> standard_deviation() const {
    if (count_ < 2) raise<numeric_error>(302, "FeatureStatistics: a deviation of ", count_, " frames");
    std::vector<double> out;
    for (double s : squares_) out.push_back(std::sqrt(s / static_cast<double>(count_ - 1)));
    return out;
  }

 private:
  Index count_ = 0;
  std::vector<double> mean_, squares_;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
