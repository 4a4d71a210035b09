// SPDX-License-Identifier: MIT
/// Convolution over time.
#pragma once

#include <motionlang/nn/init.hpp>
#include <motionlang/tensor/fused.hpp>
#include <motionlang/tensor/module.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct Conv1dOptions {
  static constexpr bool is_option = true;  // holds no tensors
  Index stride = 1, padding = 0, dilation = 1;
  bool operator==(const Conv1dOptions&) const = default;
};

/// The number of rows of the result for n rows: floor((n + 2 padding - dilation (kernel - 1) - 1) / stride) + 1. Throws
/// config_error 101 for invalid options, and shape_error 205 if the kernel does not fit into the sequence.
Index conv1d_length(Index n, Index kernel, const Conv1dOptions& o);

///     y[t] = act(bias + sum_j W[:, :, j] x[t stride + j dilation - padding]),   x = 0 outside of its sequence
/// x packed (rows, in), weight (out, in, kernel), bias (out) or null -> packed (rows', out). Every sequence is
/// convolved by itself.
/// Source  PyTorch's Conv1d, which correlates. One product of all windows with all weights. A backend with its own
///         `conv1d` need not write the windows down.
/// Throws  shape_error 201, 204, 205, config_error 101
template <Backend B>
Sequences<B> conv1d(const Sequences<B>& x, const Tensor<B, 3>& weight, const Tensor<B, 1>* bias,
                    const Conv1dOptions& o = {}, Activation act = Activation::none) {
  const Index in = weight.size(1), kernel = weight.size(2), outside = x.offsets.rows();
  if (x.width() != in) raise<shape_error>(201, "conv1d: input ", x.rows.shape(), ", weight ", weight.shape());
  if (bias != nullptr && bias->size(0) != weight.size(0))
    raise<shape_error>(204, "conv1d: bias ", bias->shape(), " for weight ", weight.shape());
  if (kernel == 1 && o == Conv1dOptions{})
    return x.with(linear(x.rows, reshape<2>(weight, {weight.size(0), in}), bias, act));
  PoolVector<Index> lengths;
  for (Index s = 0; s < x.count(); ++s) lengths.push_back(conv1d_length(x.offsets.length(s), kernel, o));
  const Offsets offsets{std::span<const Index>(lengths)};
  using T = const typename B::tensor*;
  if constexpr (requires { B::conv1d(x.rows.data(), offsets, offsets, weight.data(), T{}, in, in, act); }) {
    if (o.dilation == 1) {
      return {Tensor<B, 2>(B::conv1d(x.rows.data(), x.offsets, offsets, weight.data(),
                                     bias == nullptr ? nullptr : &bias->data(), o.stride, o.padding, act)),
              offsets};
    }
  }
  PoolVector<Index> pick;
  for (Index s = 0; s < x.count(); ++s) {
    const Index n = x.offsets.length(s);
    for (Index t = 0; t < offsets.length(s); ++t) {
      for (Index j = 0; j < kernel; ++j) {
        const Index at = t * o.stride + j * o.dilation - o.padding;
        pick.push_back(at < 0 || at >= n ? outside : x.offsets.begin(s) + at);
      }
    }
  }
  const auto padded = o.padding == 0 ? x.rows : concat(0, x.rows, Tensor<B, 2>::zeros({1, in}));
  const auto windows = reshape<2>(gather(padded, pick), {offsets.rows(), kernel * in});
  const auto matrix = reshape<2>(permute(weight, {0, 2, 1}), {weight.size(0), kernel * in});
  return {linear(windows, matrix, bias, act), offsets};
}

template <Backend B>
struct Conv1d {
  Tensor<B, 3> weight;  // (out, in, kernel)
  Tensor<B, 1> bias;    // (out)
  Conv1dOptions options;

  static constexpr auto fields() {
    return motionlang::fields("weight", &Conv1d::weight, "bias", &Conv1d::bias, "options", &Conv1d::options);
  }
  Conv1d() = default;
  /// PyTorch's initialisation: weight and bias uniform within 1 / sqrt(in kernel).
  Conv1d(Index in, Index out, Index kernel, const Conv1dOptions& o, Rng auto& rng) : options(o) {
    const double bound = 1 / std::sqrt(static_cast<double>(in * kernel));
    weight = uniform_init<B, 3>({out, in, kernel}, bound, rng);
    bias = uniform_init<B, 1>({out}, bound, rng);
  }

  Sequences<B> operator()(const Sequences<B>& x, Activation act = Activation::none) const {
    const ModuleScope scope(*this);
    return conv1d(x, weight, &bias, options, act);
  }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/nn/conv1d.ipp>
#endif
