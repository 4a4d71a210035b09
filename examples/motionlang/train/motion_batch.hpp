// Motions as a model takes them: batches that are normalised.
#pragma once

#include <span>
#include <vector>

#include <motionlang/nn/sequence_vae.hpp>

#include "feature_statistics.hpp"

namespace program {

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
