// The models that are measured, at their published sizes, with random weights and inputs: made once, then called like a
// function. `gflop` is what is computed without any of the exact savings, so that figures of all programs compare.
#pragma once

#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/systems/tmr.hpp>
#include <motionlang/vae/actor_decoder.hpp>

#include "bench.hpp"

namespace bench {

using ml::Index;

/// "B=2 T=200"
inline std::string shape(Index sequences, Index length) {
  return "B=" + std::to_string(sequences) + " T=" + std::to_string(length);
}
inline std::vector<Index> equal(Index count, Index length) {
  return std::vector<Index>(static_cast<std::size_t>(count), length);
}

/// The MDM shape: 8 layers, width 512, feed-forward 1024, 4 heads.
inline constexpr ml::MdmSmplConfig mdm{.nfeats = 205,
                                       .tx_dim = 512,
                                       .latent_dim = 512,
                                       .ff_size = 1024,
                                       .num_layers = 8,
                                       .num_heads = 4,
                                       .nb_registers = 2};
inline constexpr Index width = 256, feed_forward = 1024, guo = 263;  // the autoencoders; HumanML3D's features

template <ml::Backend B>
struct MdmBatch {
  ml::Sequences<B> x;
  std::vector<Index> t;
  ml::TextFeatures<B> text;

  MdmBatch(const std::vector<Index>& lengths, ml::Philox rng)
      : x(ml::Tensor<B, 2>::randn({ml::Offsets(lengths).rows(), mdm.nfeats}, rng), ml::Offsets(lengths)),
        t(lengths.size(), 50),
        text(ml::TextFeatures<B>::pooled(ml::Tensor<B, 2>::randn({std::ssize(lengths), mdm.tx_dim}, rng))) {}
  double gflop() const {
    double total = 0;
    for (Index i = 0; i < x.count(); ++i) {
      const auto n = static_cast<double>(x.offsets.length(i));
      total += encoder_gflop(n + 4, 512, 1024, 8) + 4 * n * 205 * 512e-9;
    }
    return total;
  }
};

/// One denoising step of guided sampling: crops of these lengths, each with its text and without.
template <ml::Backend B>
struct MdmStep {
  ml::MdmSmplDenoiser<B> model;
  MdmBatch<B> crops, texts;  // texts: two for each crop
  ml::Offsets uses;

  explicit MdmStep(const std::vector<Index>& lengths, ml::Philox rng = {.seed = 1})
      : model(mdm, rng),
        crops(lengths, rng),
        texts(equal(2 * std::ssize(lengths), 1), rng),
        uses(ml::Offsets::equal(std::ssize(lengths), 2)) {
    ml::prepare(model);
  }
  void operator()() const { model(crops.x, uses, texts.t, model.encode(texts.text)); }
  double gflop() const { return 2 * crops.gflop(); }
};

inline double encoder_gflop_of(double frames, double features) {
  return encoder_gflop(frames + 2, width, feed_forward, 6) + 2e-9 * frames * features * width;
}
inline double decoder_gflop_of(double frames, double features, double layers) {
  return encoder_gflop(frames, width, feed_forward, layers) + 4e-9 * layers * frames * width * width +
         2e-9 * frames * features * width;
}

/// TMR's motion encoder on motions of 200 frames.
template <ml::Backend B>
struct TmrEncoding {
  ml::TmrEncoder<B> model;
  ml::Sequences<B> x;

  explicit TmrEncoding(Index n, ml::Philox rng = {.seed = 1})
      : model(guo, true, ml::transformer_of(ml::TmrConfig{}), 5000, rng),
        x(ml::Tensor<B, 2>::randn({n * 200, guo}, rng), ml::Offsets::equal(n, 200)) {
    ml::prepare(model);
  }
  void operator()() const { model(x); }
  double gflop() const { return static_cast<double>(x.count()) * encoder_gflop_of(200, guo); }
};

/// The decoder of TEMOS and TMR, 200 frames.
template <ml::Backend B>
struct TemosDecoding {
  ml::SequenceDecoder<B> model;
  ml::Tensor<B, 2> z;

  explicit TemosDecoding(Index n, ml::Philox rng = {.seed = 1})
      : model(guo, ml::transformer_of(ml::TmrConfig{}), 5000, rng), z(ml::Tensor<B, 2>::randn({n, width}, rng)) {
    ml::prepare(model);
  }
  void operator()() const { model(z, ml::Offsets::equal(z.size(0), 200)); }
  double gflop() const { return static_cast<double>(z.size(0)) * decoder_gflop_of(200, guo, 6); }
};

/// ACTOR's decoder, 60 frames.
template <ml::Backend B>
struct ActorDecoding {
  ml::ActorDecoder<B> model;
  ml::Tensor<B, 2> z;
  std::vector<Index> labels;

  explicit ActorDecoding(Index n, ml::Philox rng = {.seed = 1})
      : model(150, 12, {.d_model = width, .heads = 4, .d_ff = feed_forward, .layers = 8}, 5000,
              ml::ActorConditioning::action_bias, rng),
        z(ml::Tensor<B, 2>::randn({n, width}, rng)),
        labels(equal(n, 3)) {
    ml::prepare(model);
  }
  void operator()() const { model(z, labels, ml::Offsets::equal(z.size(0), 60)); }
  double gflop() const { return static_cast<double>(z.size(0)) * decoder_gflop_of(60, 150, 8); }
};

}  // namespace bench
