// SPDX-License-Identifier: MIT
/// Transposed convolution over time: the adjoint of conv1d, which makes sequences longer.
#pragma once

#include <motionlang/nn/conv1d.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     y[t stride + j - padding] += W[:, :, j]^T x[t],   y begins as the bias
/// x packed (rows, in), weight (in, out, kernel), bias (out) -> packed; n rows become (n - 1) stride + kernel - 2
/// padding.
/// Source  PyTorch's ConvTranspose1d. One product, whose rows are added.
/// Throws  shape_error 201, 205, config_error 101
template <Backend B>
Sequences<B> conv_transpose1d(const Sequences<B>& x, const Tensor<B, 3>& weight, const Tensor<B, 1>& bias, Index stride,
                              Index padding) {
  const Index in = weight.size(0), out = weight.size(1), kernel = weight.size(2);
  if (stride < 1 || padding < 0) raise<config_error>(101, "conv_transpose1d: stride ", stride, ", padding ", padding);
  if (x.width() != in) raise<shape_error>(201, "conv_transpose1d: input ", x.rows.shape(), ", weight ", weight.shape());
  PoolVector<Index> lengths, to;
  for (Index s = 0; s < x.count(); ++s) {
    const Index n = x.offsets.length(s), after = (n - 1) * stride + kernel - 2 * padding;
    if (n < 1 || after < 1) raise<shape_error>(205, "conv_transpose1d: of ", n, " rows ", after, " are left");
    lengths.push_back(after);
  }
  const Offsets offsets{std::span<const Index>(lengths)};
  const Index outside = offsets.rows();
  for (Index s = 0; s < x.count(); ++s) {
    for (Index t = 0; t < x.offsets.length(s); ++t) {
      for (Index j = 0; j < kernel; ++j) {
        const Index at = t * stride + j - padding;
        to.push_back(at < 0 || at >= offsets.length(s) ? outside : offsets.begin(s) + at);
      }
    }
  }
  const auto matrix = reshape<2>(permute(weight, {2, 1, 0}), {kernel * out, in});
  const auto parts = reshape<2>(linear<B>(x.rows, matrix, nullptr), {x.offsets.rows() * kernel, out});
  return {slice(scatter_add(parts, to, outside + 1), 0, 0, outside) + bias, offsets};
}

template <Backend B>
struct ConvTranspose1d {
  Tensor<B, 3> weight;  // (in, out, kernel)
  Tensor<B, 1> bias;    // (out)
  Index stride = 1, padding = 0;

  static constexpr auto fields() {
    using M = ConvTranspose1d;
    return motionlang::fields("weight", &M::weight, "bias", &M::bias, "stride", &M::stride, "padding", &M::padding);
  }
  ConvTranspose1d() = default;
  /// PyTorch's initialisation: weight and bias uniform within 1 / sqrt(out kernel).
  ConvTranspose1d(Index in, Index out, Index kernel, Index stride_, Index padding_, Rng auto& rng)
      : stride(stride_), padding(padding_) {
    const double bound = 1 / std::sqrt(static_cast<double>(out * kernel));
    weight = uniform_init<B, 3>({in, out, kernel}, bound, rng);
    bias = uniform_init<B, 1>({out}, bound, rng);
  }

  Sequences<B> operator()(const Sequences<B>& x) const {
    const ModuleScope scope(*this);
    return conv_transpose1d(x, weight, bias, stride, padding);
  }
};

MOTIONLANG_NAMESPACE_END
