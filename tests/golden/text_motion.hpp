// The autoencoders of golden cases (TEMOS, TMR): sizes from the config, packed inputs, intermediate outputs, gradients.
#pragma once

#include <motionlang/systems/temos.hpp>
#include <motionlang/systems/tmr.hpp>

#include "tensors.hpp"

namespace golden {

using ml::Index;

inline ml::TransformerConfig transformer_of(const ml::JsonView& config) {
  return {.d_model = config["latent_dim"].as<Index>(),
          .heads = config["num_heads"].as<Index>(),
          .d_ff = config["ff_size"].as<Index>(),
          .layers = config["num_layers"].as<Index>(),
          .activation = ml::parse_activation(config.value_or("activation", std::string("gelu")))};
}
inline bool variational(const ml::JsonView& config) { return config.value_or("vae", true); }

/// in/NAME [B, T, width] without its padding.
template <ml::Backend B>
ml::Sequences<B> packed(const Case& c, const std::string& name, const std::string& mask) {
  const auto valid = c.values<unsigned char>("in/" + mask);
  return ml::from_padded(tensor<B, 3>(c, "in/" + name), std::span<const unsigned char>(valid));
}
inline ml::Offsets lengths_of(const Case& c, const std::string& name = "in/lengths") {
  return ml::Offsets(c.values<Index>(name));
}
/// How many frames the padded tensors of the case have: as many as the mask.
inline Index padded_frames(const Case& c, const std::string& mask = "in/mask") { return c.shape(mask)[1]; }

/// The layout of sequences in the file: TEMOS has time first, TMR the batch.
enum class Layout { batch_first, time_first };

template <ml::Backend B>
void out_padded(Case& c, const std::string& name, const ml::Sequences<B>& x, Index frames, Layout layout) {
  if (!c.wants(name)) return;
  const auto padded = ml::to_padded(x, 0, frames);
  out(c, name, layout == Layout::time_first ? ml::permute(padded, {1, 0, 2}) : padded);
}
/// Writes the input of an encoder's stack, and the outputs of its first and last layer.
template <ml::Backend B>
void out_encoder_layers(Case& c, const ml::TransformerEncoder<B>& stack, ml::Sequences<B> x, Index frames,
                        Layout layout) {
  out_padded(c, "sequence", x, frames, layout);
  for (std::size_t i = 0; i < stack.layers.size(); ++i) {
    x.rows = stack.layers[i](x.rows, x.offsets);
    if (i == 0) out_padded(c, "layer_0", x, frames, layout);
  }
  out_padded(c, "layer_last", x, frames, layout);
}
/// The same of a decoder, with the first two thirds of its first layer.
template <ml::Backend B>
void out_decoder_layers(Case& c, const ml::SequenceDecoder<B>& m, const ml::Tensor<B, 2>& z, const ml::Offsets& lengths,
                        Index frames, Layout layout) {
  auto x = ml::position_queries(m.positions.rows(), lengths);
  const ml::Sequences<B> memory(z, ml::Offsets::equal(z.size(0), 1));
  const auto& layers = m.seqTransDecoder.layers;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if (i == 0) {
      const auto self = layers[i].attend_self(x.rows, lengths);
      out_padded(c, "layer_0_self", x.with(self), frames, layout);
      out_padded(c, "layer_0_cross", x.with(layers[i].attend_memory(self, lengths, memory)), frames, layout);
    }
    x.rows = layers[i](x.rows, lengths, memory);
    if (i == 0) out_padded(c, "layer_0", x, frames, layout);
  }
  out_padded(c, "layer_last", x, frames, layout);
}
/// mu and its partner, or the latent of a deterministic encoder.
template <ml::Backend B>
void out_latent(Case& c, const ml::LatentGaussian<B>& g) {
  out(c, g.deterministic() ? "latent" : "mu", g.mu);
  if (g.deterministic()) return;
  out_if_wanted(c, "logvar", g.logvar);
  out_if_wanted(c, "std", g.std());
}
/// noise/NAME, or nothing in particular where the case has none (deterministic models).
template <ml::Backend B>
ml::Tensor<B, 2> noise(const Case& c, const std::string& name) {
  return c.has("noise/" + name) ? tensor<B, 2>(c, "noise/" + name) : ml::Tensor<B, 2>();
}

/// Decoders of all systems, and TEMOS' motion encoder, which TEACH and SINC have too: the whole case is of this module.
template <ml::Backend B>
ml::SequenceDecoder<B> sequence_decoder(const Case& c) {
  ml::Philox rng;
  ml::SequenceDecoder<B> m(c.config()["nfeats"].as<Index>(), transformer_of(c.config()), position_rows, rng);
  ml::load_module(m, c.file(), "weights/");
  return m;
}
template <ml::Backend B>
ml::TemosMotionEncoder<B> temos_motion_encoder(const Case& c) {
  ml::Philox rng;
  ml::TemosMotionEncoder<B> m(c.config()["nfeats"].as<Index>(), true, transformer_of(c.config()), position_rows, rng);
  ml::load_module(m, c.file(), "weights/");
  return m;
}
/// A decoder case of one latent for each motion, with its intermediate results. `output`: what the file calls the
/// frames.
template <ml::Backend B>
void decoder_forward(Case& c, Layout layout, const std::string& output) {
  const auto m = sequence_decoder<B>(c);
  const auto z = tensor<B, 2>(c, "in/z");
  const auto lengths = lengths_of(c);
  const Index frames = padded_frames(c);
  out_decoder_layers(c, m, z, lengths, frames, layout);
  out_padded(c, output, m(z, lengths), frames, Layout::batch_first);
}

/// A model with the modules that the case has weights of.
template <ml::Backend B>
ml::Temos<B> temos_model(const Case& c) {
  const auto config = c.config();
  const bool motion = !c.names("weights/motionencoder.").empty();
  ml::Philox rng;
  ml::Temos<B> m({.nfeats = config["nfeats"].template as<Index>(),
                  .text_dim = config["text_dim"].template as<Index>(),
                  .latent_dim = config["latent_dim"].template as<Index>(),
                  .ff_size = config["ff_size"].template as<Index>(),
                  .num_layers = config["num_layers"].template as<Index>(),
                  .num_heads = config["num_heads"].template as<Index>(),
                  .activation = ml::parse_activation(config["activation"].template as<std::string>()),
                  .vae = variational(config),
                  .motion_encoder = motion ? ml::TemosNetwork::transformer : ml::TemosNetwork::none,
                  .max_len = position_rows},
                 rng);
  ml::load_module(m, c.file(), "weights/");
  return m;
}

/// A model with the modules that the case has weights of; the others are never called.
template <ml::Backend B>
ml::Tmr<B> tmr_model(const Case& c) {
  const auto config = c.config();
  ml::Philox rng;
  ml::Tmr<B> m({.motion_nfeats = config["motion_nfeats"].template as<Index>(),
                .text_nfeats = config["text_nfeats"].template as<Index>(),
                .latent_dim = config["latent_dim"].template as<Index>(),
                .ff_size = config["ff_size"].template as<Index>(),
                .num_layers = config["num_layers"].template as<Index>(),
                .num_heads = config["num_heads"].template as<Index>(),
                .activation = ml::parse_activation(config["activation"].template as<std::string>()),
                .vae = variational(config),
                .max_len = position_rows},
               rng);
  ml::load_module(m.text_encoder, c.file(), "weights/text_encoder.");
  ml::load_module(m.motion_encoder, c.file(), "weights/motion_encoder.");
  if (!c.names("weights/motion_decoder.").empty())
    ml::load_module(m.motion_decoder, c.file(), "weights/motion_decoder.");
  return m;
}

}  // namespace golden
