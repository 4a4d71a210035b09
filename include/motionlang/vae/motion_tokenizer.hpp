// SPDX-License-Identifier: MIT
/// TM2T's motion tokenizer: four frames become one entry of a codebook, and entries become frames.
///
///     const IdSequences tokens = tokenizer.tokens(normalized);       // a quarter as many as frames
///     const Sequences<B> motion = tokenizer.motions(tokens);         // normalised features
///
/// Source  Guo et al., "TM2T: stochastic and tokenized modeling for the reciprocal generation of 3D human motions and
///         texts" (ECCV 2022), section 3.1; networks/modules.py, networks/trainers.py (VQTokenizerTrainerV3)
#pragma once

#include <motionlang/loss/adversarial.hpp>
#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/loss/reconstruction.hpp>
#include <motionlang/nn/conv_stack.hpp>
#include <motionlang/nn/vector_quantizer.hpp>
#include <motionlang/tensor/id_sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The ids of motion tokens: codes, then the marks of start, end and padding.
struct MotionVocabulary {
  Index codes = 1024;
  Index begin() const { return codes; }
  Index end() const { return codes + 1; }
  Index pad() const { return codes + 2; }
  Index size() const { return codes + 3; }
};

/// For each number of channels: a convolution that halves the length, and a residual block.
template <Backend B>
struct VqEncoder {
  ConvStack<B> main;

  static constexpr auto fields() { return motionlang::fields("main", &VqEncoder::main); }
  VqEncoder() = default;
  VqEncoder(Index in, std::span<const Index> channels, Rng auto& rng) {
    for (Index out : channels) {
      main.conv(in, out, 4, {.stride = 2, .padding = 1}, rng).leaky_relu().residual(out, rng);
      in = out;
    }
  }
  Sequences<B> operator()(const Sequences<B>& x) const {
    const ModuleScope scope(*this);
    return main(x);
  }
};

/// Residual blocks; then for each further number of channels twice the length and a convolution; then a last
/// convolution.
/// If the latent has another width than the first number of channels, a convolution comes first. Differs from the table
/// of the paper: three residual blocks, as published, not two.
template <Backend B>
struct VqDecoder {
  ConvStack<B> main;

  static constexpr auto fields() { return motionlang::fields("main", &VqDecoder::main); }
  VqDecoder() = default;
  /// Throws config_error 101 without channels.
  VqDecoder(Index latent, std::span<const Index> channels, Index residual_blocks, Rng auto& rng) {
    if (channels.empty()) raise<config_error>(101, "VqDecoder: no channels");
    const Conv1dOptions same{.padding = 1};
    if (latent != channels.front()) main.conv(latent, channels.front(), 3, same, rng);
    for (Index i = 0; i < residual_blocks; ++i) main.residual(channels.front(), rng);
    for (std::size_t i = 0; i + 1 < channels.size(); ++i)
      main.repeat(2).conv(channels[i], channels[i + 1], 3, same, rng).leaky_relu();
    main.conv(channels.back(), channels.back(), 3, same, rng);
  }
  Sequences<B> operator()(const Sequences<B>& z) const {
    const ModuleScope scope(*this);
    return main(z);
  }
};

/// Tells real motions from decoded ones, four frames at a time. The paper does not describe it.
template <Backend B>
struct VqDiscriminator {
  ConvStack<B> main;
  Conv1d<B> out_net;

  static constexpr auto fields() {
    return motionlang::fields("main", &VqDiscriminator::main, "out_net", &VqDiscriminator::out_net);
  }
  VqDiscriminator() = default;
  /// Each layer has half as many channels as the one before.
  VqDiscriminator(Index in, Index hidden, Index layers, Rng auto& rng) {
    for (Index i = 0; i < layers; ++i) {
      main.conv(in, hidden, 4, {.stride = 2, .padding = 1}, rng).norm(hidden).leaky_relu();
      in = hidden;
      if (i + 1 < layers) hidden /= 2;
    }
    out_net = detail::xavier_conv<B>(hidden, 1, 3, {.padding = 1}, rng);
  }

  struct Result {
    Sequences<B> features;
    Tensor<B, 2> logits;  // (rows, 1)
  };
  Result operator()(const Sequences<B>& x) const {
    const ModuleScope scope(*this);
    return judged(main(x));
  }
  /// Uses the statistics of these motions, and remembers them.
  Result train(const Sequences<B>& x, const Context& context = {}) { return judged(main.train(x, context)); }

 private:
  Result judged(const Sequences<B>& features) const { return {features, out_net(features).rows}; }
};

/// The published sizes.
struct MotionTokenizerConfig {
  Index features = 263;  // with the contacts, which are written but not read; KIT: 251
  std::vector<Index> channels{1024, 1024};
  Index codes = 1024, residual_blocks = 3;
  double beta = 1;
};

/// The names are those of the published checkpoint.
template <Backend B>
struct MotionTokenizer {
  VqEncoder<B> vq_encoder;
  VectorQuantizer<B> quantizer;
  VqDecoder<B> vq_decoder;

  static constexpr auto fields() {
    using M = MotionTokenizer;
    return motionlang::fields("vq_encoder", &M::vq_encoder, "quantizer", &M::quantizer, "vq_decoder", &M::vq_decoder);
  }
  MotionTokenizer() = default;
  /// Throws config_error 101 without channels.
  MotionTokenizer(const MotionTokenizerConfig& c, Rng auto& rng) {
    if (c.channels.empty()) raise<config_error>(101, "MotionTokenizer: no channels");
    const Index latent = c.channels.back();
    std::vector<Index> up(c.channels.rbegin(), c.channels.rend());
    up.push_back(c.features);
    vq_encoder = VqEncoder<B>(c.features - 4, c.channels, rng);
    quantizer = VectorQuantizer<B>(c.codes, latent, c.beta, rng);
    vq_decoder = VqDecoder<B>(latent, up, c.residual_blocks, rng);
  }

  MotionVocabulary vocabulary() const { return {quantizer.size()}; }

  /// Normalised features to latents, without the contacts.
  Sequences<B> encode(const Sequences<B>& x) const { return vq_encoder(x.with(slice(x.rows, 1, 0, x.width() - 4))); }
  IdSequences tokens(const Sequences<B>& x) const {
    const auto z = encode(x);
    return {quantizer.codes(z.rows), z.offsets};
  }
  /// Codes to normalised features. Throws shape_error 203 for an id that is not a code.
  Sequences<B> motions(const IdSequences& tokens) const {
    return vq_decoder({quantizer.embedding(tokens.ids), tokens.offsets});
  }

  struct Result {
    Quantized<B> quantized;
    Sequences<B> reconstruction;
  };
  /// TM2T eq. 2: decodes the codes nearest to the encoder's latents.
  Result operator()(const Sequences<B>& x) const {
    const ModuleScope scope(*this);
    const auto z = encode(x);
    auto quantized = quantizer(z.rows);
    auto reconstruction = vq_decoder(z.with(quantized.straight_through));
    return {std::move(quantized), std::move(reconstruction)};
  }
};

///     mean |x^ - x| + quantisation [- lambda mean D(x^)]
/// Source   TM2T eq. 3: the first term here, the other two in `Quantized::loss`; networks/trainers.py backward_G
/// Differs  from TM2T eq. 3, which has sums and no discriminator: here means, as published
/// With a discriminator (published: from epoch 10 on), its norms use the statistics of the decoded motions. The
/// discriminator takes its own step before, with `hinge_discriminator_loss` times lambda.
template <Backend B>
LossTerms<B> tokenizer_losses(const typename MotionTokenizer<B>::Result& result, const Sequences<B>& x,
                              VqDiscriminator<B>* discriminator = nullptr, double lambda_adv = 0.5,
                              const Context& context = {}) {
  LossTerms<B> out;
  out.add("rec", 1, l1(result.reconstruction.rows, x.rows));
  out.add("emb", 1, result.quantized.loss);
  if (discriminator != nullptr)
    out.add("adv", lambda_adv, hinge_generator_loss(discriminator->train(result.reconstruction, context).logits));
  return out;
}

MOTIONLANG_NAMESPACE_END
