// Mean and deviation of features, by which they are normalised: of the motions to train on, or of a folder.
#pragma once

#include <filesystem>
#include <vector>

#include <motionlang/features/statistics.hpp>
#include <motionlang/weights/detail/run_reader.hpp>

#include "described_motions.hpp"
#include "learner.hpp"

namespace program {

/// Mean and unbiased deviation of every feature over the frames of all motions; 1 where a feature never changes.
inline ml::Normalizer<TrainingBackend> statistics_of(const std::vector<DescribedMotion>& motions, ml::Index width) {
  ml::FeatureStatistics statistics;
  for (const DescribedMotion& m : motions) statistics.add(std::span<const float>(m.rows), width);
  std::vector<float> mean, std;
  for (const double x : statistics.mean()) mean.push_back(static_cast<float>(x));
  for (const double x : statistics.standard_deviation()) std.push_back(x < 1e-5 ? 1.0f : static_cast<float>(x));
  return {ml::Tensor<TrainingBackend, 1>::from(mean, {width}), ml::Tensor<TrainingBackend, 1>::from(std, {width})};
}

/// Mean and std of a folder: Mean.npy and Std.npy of HumanML3D and KIT-ML, mean.pt and std.pt of others.
/// Throws  io_error 401 if there are none, 407 for features of another width
inline ml::Normalizer<TrainingBackend> statistics_of(const std::filesystem::path& folder, ml::Index width) {
  return ml::detail::folder_normalizer<TrainingBackend>(
      ml::find_run(folder), width, {"", "stats.", "meta.", "motion_stats."},
      "the motions: neither Mean.npy and Std.npy nor mean.pt and std.pt");
}

/// Of a folder where one is named, else of the motions to train on.
inline ml::Normalizer<TrainingBackend> statistics_of(const std::filesystem::path& folder,
                                                     const DescribedMotions& data) {
  return folder.empty() ? statistics_of(data.training, data.width) : statistics_of(folder, data.width);
}

}  // namespace program
