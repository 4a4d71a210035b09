// SPDX-License-Identifier: MIT
/// The token that gives the diffusion step to a denoiser.
#pragma once

#include <motionlang/nn/linear.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     e = W2 silu(W1 pe[t])
/// Source  MDM (Tevet et al. 2023), `TimestepEmbedder`; keys time_embed.0 and time_embed.2. The table pe is the one of
///         the positions and belongs to the caller.
template <Backend B>
struct TimestepEmbedding {
  Linear<B> in, out;

  static constexpr auto fields() {
    return motionlang::fields("time_embed.0", &TimestepEmbedding::in, "time_embed.2", &TimestepEmbedding::out);
  }
  TimestepEmbedding() = default;
  TimestepEmbedding(Index width, Rng auto& rng) : in(width, width, rng), out(width, width, rng) {}

  /// t: one step per sequence -> (sequences, width)
  Tensor<B, 2> operator()(const Tensor<B, 2>& table, std::span<const Index> t) const {
    const ModuleScope scope(*this);
    return out(in(gather(table, t), Activation::silu));
  }
};

MOTIONLANG_NAMESPACE_END
