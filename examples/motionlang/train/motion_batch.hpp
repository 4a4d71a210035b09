// Motions as a model takes them: the statistics of their features, and batches that are normalised with these.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include <motionlang/features/normalizer.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/io/text_motion_file.hpp>
#include <motionlang/nn/sequence_vae.hpp>

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

/// Rows of features, not normalised, one motion behind the other.
template <ml::Backend B>
class MotionBatch {
 public:
  /// Holds the statistics by reference.
  explicit MotionBatch(const ml::Normalizer<B>& normalizer)
      : normalizer_(&normalizer), width_(normalizer.mean.size(0)) {}

  void add(std::span<const float> rows) {
    values_.insert(values_.end(), rows.begin(), rows.end());
    lengths_.push_back(std::ssize(rows) / width_);
  }
  /// Some frames of a motion.
  void add(std::span<const float> rows, const ml::FrameSlice& frames) {
    add(rows.subspan(static_cast<std::size_t>(frames.first * width_),
                     static_cast<std::size_t>(frames.length * width_)));
  }
  ml::Sequences<B> normalized() const {
    const ml::Offsets offsets{std::span<const ml::Index>(lengths_)};
    return {normalizer_->normalize(ml::Tensor<B, 2>::from(values_, {offsets.rows(), width_})), offsets};
  }

 private:
  const ml::Normalizer<B>* normalizer_;
  ml::Index width_;
  std::vector<typename B::scalar> values_;
  std::vector<ml::Index> lengths_;
};

}  // namespace program
