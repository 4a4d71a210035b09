// SPDX-License-Identifier: MIT
/// The convolutions before Guo's motion encoder, which turn four frames into one movement, and the autoencoder that
/// trains them.
#pragma once

#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/nn/conv_stack.hpp>
#include <motionlang/nn/linear.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

template <Backend B>
Linear<B> xavier_linear(Index in, Index out, Rng auto& rng) {
  NoInit none;
  Linear<B> layer(in, out, none);
  layer.weight = xavier_normal<B, 2>({out, in}, rng);
  layer.bias = constant_init<B, 1>({out}, 0);
  return layer;
}

}  // namespace detail

/// Two convolutions that halve the length, and a projection: n frames become floor(n / 4) movements.
/// Source  text-to-motion networks/modules.py MovementConvEncoder. Dropout comes before the nonlinearity.
template <Backend B>
struct MovementEncoder {
  ConvStack<B> main;
  Linear<B> out_net;

  static constexpr auto fields() {
    return motionlang::fields("main", &MovementEncoder::main, "out_net", &MovementEncoder::out_net);
  }
  MovementEncoder() = default;
  MovementEncoder(Index in, Index hidden, Index latent, Rng auto& rng, double dropout = 0.2)
      : out_net(detail::xavier_linear<B>(latent, latent, rng)) {
    const Conv1dOptions halving{.stride = 2, .padding = 1};
    main.conv(in, hidden, 4, halving, rng).dropout(dropout).leaky_relu();
    main.conv(hidden, latent, 4, halving, rng).dropout(dropout).leaky_relu();
  }

  /// The input is normalised features without contacts.
  Sequences<B> operator()(const Sequences<B>& x, const Context& context = {}) const {
    const ModuleScope scope(*this);
    return out_net(main(x, context));
  }
};

/// Source  text-to-motion networks/modules.py MovementConvDecoder
template <Backend B>
struct MovementDecoder {
  ConvStack<B> main;
  Linear<B> out_net;

  static constexpr auto fields() {
    return motionlang::fields("main", &MovementDecoder::main, "out_net", &MovementDecoder::out_net);
  }
  MovementDecoder() = default;
  MovementDecoder(Index latent, Index hidden, Index out, Rng auto& rng)
      : out_net(detail::xavier_linear<B>(out, out, rng)) {
    main.transposed(latent, hidden, 4, 2, 1, rng).leaky_relu();
    main.transposed(hidden, out, 4, 2, 1, rng).leaky_relu();
  }

  Sequences<B> operator()(const Sequences<B>& movements) const {
    const ModuleScope scope(*this);
    return out_net(main(movements));
  }
};

/// Both, with the names of their checkpoint.
template <Backend B>
struct MovementAutoencoder {
  MovementEncoder<B> movement_enc;
  MovementDecoder<B> movement_dec;

  static constexpr auto fields() {
    using M = MovementAutoencoder;
    return motionlang::fields("movement_enc", &M::movement_enc, "movement_dec", &M::movement_dec);
  }
  MovementAutoencoder() = default;
  /// features: including the contacts, which are written but not read.
  MovementAutoencoder(Index features, Index hidden, Index latent, Rng auto& rng, double dropout = 0.2)
      : movement_enc(features - 4, hidden, latent, rng, dropout), movement_dec(latent, hidden, features, rng) {}

  struct Result {
    Sequences<B> latents, reconstruction;
  };
  Result operator()(const Sequences<B>& x, const Context& context = {}) const {
    const ModuleScope scope(*this);
    const auto latents = movement_enc(x.with(slice(x.rows, 1, 0, x.width() - 4)), context);
    return {latents, movement_dec(latents)};
  }
};

///     rec = mean |x^ - x|,   sparsity = mean |z|,   smooth = mean |z_{t+1} - z_t|
/// Source  text-to-motion networks/trainers.py DecompTrainerV3
template <Backend B>
LossTerms<B> movement_losses(const typename MovementAutoencoder<B>::Result& result, const Sequences<B>& x,
                             double lambda_sparsity = 0.001, double lambda_smooth = 0.001) {
  LossTerms<B> out;
  out.add("rec", 1, l1(result.reconstruction.rows, x.rows));
  out.add("sparsity", lambda_sparsity, mean(abs(result.latents.rows)));
  out.add("smooth", lambda_smooth, mean(abs(frame_steps(result.latents))));
  return out;
}

MOTIONLANG_NAMESPACE_END
