// SPDX-License-Identifier: MIT
/// Batches of normalised motions for a model.
#pragma once

#include <span>    // rows
#include <vector>  // rows

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Rows of features, not normalised, motion after motion.
template <Backend B>
class MotionBatch {
 public:
  /// Holds the statistics by reference.
  explicit MotionBatch(const Normalizer<B>& normalizer) : normalizer_(&normalizer), width_(normalizer.mean.size(0)) {}

  void add(std::span<const float> rows) {
    values_.insert(values_.end(), rows.begin(), rows.end());
    lengths_.push_back(std::ssize(rows) / width_);
  }
  /// Adds some frames of a motion.
  void add(std::span<const float> rows, const FrameSlice& frames) {
    add(rows.subspan(static_cast<std::size_t>(frames.first * width_),
                     static_cast<std::size_t>(frames.length * width_)));
  }
  Sequences<B> normalized() const {
    const Offsets offsets{std::span<const Index>(lengths_)};
    return {normalizer_->normalize(Tensor<B, 2>::from(values_, {offsets.rows(), width_})), offsets};
  }

 private:
  const Normalizer<B>* normalizer_;
  Index width_;
  std::vector<typename B::scalar> values_;
  std::vector<Index> lengths_;
};

MOTIONLANG_NAMESPACE_END
