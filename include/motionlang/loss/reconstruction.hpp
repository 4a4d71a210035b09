// SPDX-License-Identifier: MIT
/// Losses that compare values with true values.
#pragma once

#include <algorithm>  // max

#include <motionlang/tensor/ops.hpp>
#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// mean((a - b)^2) over all elements.
template <Backend B, int R>
Tensor<B, 0> mse(const Tensor<B, R>& a, const Tensor<B, R>& b) {
  return mean(square(a - b));
}

/// mean |a - b| over all elements.
template <Backend B, int R>
Tensor<B, 0> l1(const Tensor<B, R>& a, const Tensor<B, R>& b) {
  return mean(abs(a - b));
}

namespace detail {
/// d^2 / 2 where |d| < 1, else |d| - 1/2.
template <Backend B, int R>
Tensor<B, R> huber(const Tensor<B, R>& difference) {
  const auto d = abs(difference);
  return where_less(d, Tensor<B, R>(1.0), square(d) * 0.5, d - 0.5);
}
}  // namespace detail

/// Huber's loss with threshold 1, averaged: d^2 / 2 where |d| < 1, else |d| - 1/2.
template <Backend B, int R>
Tensor<B, 0> smooth_l1(const Tensor<B, R>& a, const Tensor<B, R>& b) {
  return mean(detail::huber(a - b));
}

namespace detail {
/// The number of values in a batch that is padded to this many frames, or to the longest sequence.
template <Backend B>
double padded_count(const Sequences<B>& a, Index frames) {
  return static_cast<double>(a.count() * std::max(frames, a.offsets.longest()) * a.width());
}
}  // namespace detail

/// Sum of squares over the rows, divided by the number of values in a padded batch:
///    loss = sum (a - b)^2 / (count * frames * width)
/// frames   of the padded batch, if more than in the longest sequence
/// Source   thesis eq. 6.5, as STMC src/model/gaussian.py diffusion_step trains with it
/// Differs  from thesis eq. 6.5, which is a squared norm. This is a mean: padding adds nothing to the sum, but counts
///          in the divisor
template <Backend B>
Tensor<B, 0> padded_mse(const Sequences<B>& a, const Tensor<B, 2>& b, Index frames = 0) {
  return sum(square(a.rows - b)) * (1.0 / detail::padded_count(a, frames));
}

/// smooth_l1 with the same mean over a padded batch. Source  TEMOS temos/model/losses/compute.py, TMR src/model/tmr.py
template <Backend B>
Tensor<B, 0> padded_smooth_l1(const Sequences<B>& a, const Tensor<B, 2>& b, Index frames = 0) {
  return sum(detail::huber(a.rows - b)) * (1.0 / detail::padded_count(a, frames));
}

/// The mean over the sequences of their smooth_l1. A short sequence has the same weight as a long one.
/// Source  TEACH teach/model/losses/compute_teach.py
template <Backend B>
Tensor<B, 0> smooth_l1_of_sequences(const Sequences<B>& a, const Tensor<B, 2>& b) {
  std::vector<typename B::scalar> share;  // of each row
  for (Index s : sequence_of_row(a.offsets))
    share.push_back(
        static_cast<typename B::scalar>(1.0 / static_cast<double>(a.count() * a.offsets.length(s) * a.width())));
  return sum(detail::huber(a.rows - b) * Tensor<B, 2>::from(share, {a.offsets.rows(), 1}));
}

/// The differences from each frame to the next, of every sequence: (rows - sequences, width).
template <Backend B>
Tensor<B, 2> frame_steps(const Sequences<B>& x) {
  PoolVector<Index> from, to;
  for (Index s = 0; s < x.count(); ++s) {
    for (Index r = x.offsets.begin(s); r + 1 < x.offsets.end(s); ++r) from.push_back(r), to.push_back(r + 1);
  }
  return gather(x.rows, to) - gather(x.rows, from);
}

/// mse of the differences from frame to frame. Throws shape_error 204 unless both have the same frames.
template <Backend B>
Tensor<B, 0> velocity_mse(const Sequences<B>& a, const Sequences<B>& b) {
  if (!(a.offsets == b.offsets))
    raise<shape_error>(204, "velocity_mse: sequences of other lengths: ", a.rows.shape(), ", ", b.rows.shape());
  return mse(frame_steps(a), frame_steps(b));
}

/// MDM's masked loss, (sequences): for each the sum of squares over its frames and features / (frames * width + 1e-8).
template <Backend B>
Tensor<B, 1> mse_per_sequence(const Sequences<B>& a, const Tensor<B, 2>& b) {
  const auto squares = sum(square(a.rows - b), 1);  // (rows)
  std::vector<Index> owner;
  std::vector<typename B::scalar> weight;
  for (Index s = 0; s < a.count(); ++s) {
    const Index n = a.offsets.length(s);
    owner.insert(owner.end(), static_cast<std::size_t>(n), s);
    weight.push_back(static_cast<typename B::scalar>(1.0 / (static_cast<double>(n * a.width()) + 1e-8)));
  }
  return scatter_add(squares, owner, a.count()) * Tensor<B, 1>::from(weight, {a.count()});
}

MOTIONLANG_NAMESPACE_END
