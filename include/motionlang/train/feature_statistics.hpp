// SPDX-License-Identifier: MIT
/// Mean and deviation for normalising features: of the training motions, or from a folder.
#pragma once

#include <filesystem>  // folders
#include <vector>      // values

#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/weights/detail/run_reader.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Mean and unbiased deviation of the rows that were added. A constant feature gets the deviation 1.
template <Backend B>
Normalizer<B> normalizer_of(const FeatureStatistics& statistics) {
  using S = typename B::scalar;
  std::vector<S> mean, std;
  for (const double x : statistics.mean()) mean.push_back(static_cast<S>(x));
  for (const double x : statistics.standard_deviation()) std.push_back(x < 1e-5 ? S(1) : static_cast<S>(x));
  const Index width = std::ssize(mean);
  return {Tensor<B, 1>::from(mean, {width}), Tensor<B, 1>::from(std, {width})};
}

}  // namespace detail

/// Mean and unbiased deviation of every feature over the frames of all motions. A constant feature gets the deviation
/// 1.
template <Backend B>
Normalizer<B> statistics_of(const std::vector<DescribedMotion>& motions, Index width) {
  FeatureStatistics statistics;
  for (const DescribedMotion& m : motions) statistics.add(std::span<const float>(m.rows), width);
  return detail::normalizer_of<B>(statistics);
}

/// Mean and deviation in a folder: Mean.npy and Std.npy of HumanML3D and KIT-ML, mean.pt and std.pt of others.
/// Throws  io_error 401 if there are none, 407 for features of another width
template <Backend B>
Normalizer<B> statistics_of(const std::filesystem::path& folder, Index width) {
  return detail::folder_normalizer<B>(find_run(folder), width, {"", "stats.", "meta.", "motion_stats."},
                                      "the motions: neither Mean.npy and Std.npy nor mean.pt and std.pt");
}

/// Those of a folder if one is given, otherwise those of the training motions.
template <Backend B>
Normalizer<B> statistics_of(const std::filesystem::path& folder, const DescribedMotions& data) {
  return folder.empty() ? statistics_of<B>(data.training, data.width) : statistics_of<B>(folder, data.width);
}

MOTIONLANG_NAMESPACE_END
