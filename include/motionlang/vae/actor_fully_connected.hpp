// SPDX-License-Identifier: MIT
/// The fully connected encoder and decoder that ACTOR is compared with (thesis table 3.4). All motions have one length.
#pragma once

#include <motionlang/nn/embedding.hpp>
#include <motionlang/nn/sequence_vae.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     h = gelu(W2 gelu(W1 [all numbers of the motion, one-hot y]));   mu and logvar from h
/// Values are ordered by feature, then frame. Source  thesis 3.3.2, table 3.4; ACTOR src/models/architectures
template <Backend B>
struct ActorFullyConnectedEncoder {
  Linear<B> first, second, mu, var;

  static constexpr auto fields() {
    using M = ActorFullyConnectedEncoder;
    return motionlang::fields("fully_connected.0", &M::first, "fully_connected.2", &M::second, "mu", &M::mu, "var",
                              &M::var);
  }
  ActorFullyConnectedEncoder() = default;
  ActorFullyConnectedEncoder(Index nfeats, Index frames, Index classes, Index width, Rng auto& rng)
      : first(nfeats * frames + classes, 512, rng), second(512, 256, rng), mu(256, width, rng), var(256, width, rng) {}

  /// Throws shape_error 207 unless all motions have as many frames as the network expects.
  LatentGaussian<B> operator()(const Sequences<B>& x, std::span<const Index> labels, Index classes) const {
    const ModuleScope scope(*this);
    const Index n = x.count(), frames = (first.in() - classes) / std::max<Index>(x.width(), 1);
    if (!(x.offsets == Offsets::equal(n, frames)))
      raise<shape_error>(207, "ActorFullyConnectedEncoder: motions of another length than ", frames, " frames");
    const auto by_feature = permute(reshape<3>(x.rows, {n, frames, x.width()}), {0, 2, 1});
    const auto numbers = reshape<2>(by_feature, {n, x.width() * frames});
    const auto h = second(first(concat(1, numbers, one_hot<B>(labels, classes)), Activation::gelu), Activation::gelu);
    return {mu(h), var(h)};
  }
};

///     gelu(W3 gelu(W2 gelu(W1 [z, one-hot y]))): the last activation is as published, although features may be
///     negative
template <Backend B>
struct ActorFullyConnectedDecoder {
  Linear<B> first, second, third;

  static constexpr auto fields() {
    using M = ActorFullyConnectedDecoder;
    return motionlang::fields("fully_connected.0", &M::first, "fully_connected.2", &M::second, "fully_connected.4",
                              &M::third);
  }
  ActorFullyConnectedDecoder() = default;
  ActorFullyConnectedDecoder(Index nfeats, Index frames, Index classes, Index width, Rng auto& rng)
      : first(width + classes, 256, rng), second(256, 512, rng), third(512, nfeats * frames, rng) {}

  /// Throws shape_error 207 unless all lengths are that of the network.
  Sequences<B> operator()(const Tensor<B, 2>& z, std::span<const Index> labels, const Offsets& lengths,
                          Index nfeats) const {
    const ModuleScope scope(*this);
    const Index n = z.size(0), frames = third.out() / nfeats;
    if (!(lengths == Offsets::equal(n, frames)))
      raise<shape_error>(207, "ActorFullyConnectedDecoder: motions of another length than ", frames, " frames");
    const auto input = concat(1, z, one_hot<B>(labels, first.in() - z.size(1)));
    const auto h = second(first(input, Activation::gelu), Activation::gelu);
    const auto by_feature = reshape<3>(third(h, Activation::gelu), {n, nfeats, frames});
    return {reshape<2>(permute(by_feature, {0, 2, 1}), {n * frames, nfeats}), lengths};
  }
};

MOTIONLANG_NAMESPACE_END
