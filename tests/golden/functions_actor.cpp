// Golden functions: ACTOR's networks, those it is compared with, and generation.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/core/torch_random.hpp>

#include "actor_models.hpp"
#include "seeds.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

/// A model of which one part will be used.
template <ml::Backend B>
ml::Actor<B> empty_model(const ml::ActorConfig& config) {
  ml::NoInit zeros;
  return ml::Actor<B>(config, zeros);
}

/// The layers of an encoder, as far as the case has them.
template <ml::Backend B, class E>
void encoder_layers(Case& c, const E& encoder, ml::Sequences<B> x, Index tokens) {
  const Index time = c.shape("in/x")[3] + tokens;
  golden::out_if_wanted(c, "sequence", golden::time_first(x, time));
  const auto& layers = encoder.seqTransEncoder.layers;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    x.rows = layers[i](x.rows, x.offsets);
    if (i == 0) golden::out_if_wanted(c, "layer_0", golden::time_first(x, time));
    if (i + 1 == layers.size()) golden::out_if_wanted(c, "layer_last", golden::time_first(x, time));
  }
}

template <ml::Backend B>
void encoder_forward(Case& c) {
  const auto config = golden::actor_config(c);
  auto m = empty_model<B>(config);
  const auto x = golden::motions<B>(c);
  const auto y = c.values<Index>("in/y");
  auto embedded = [&](const auto& encoder) {
    golden::out_if_wanted(c, "embedded", golden::time_first(encoder.skelEmbedding(x), c.shape("in/x")[3]));
  };
  if (m.average_encoder) {
    ml::load_module(*m.average_encoder, c.file(), "weights/");
    embedded(*m.average_encoder);
    encoder_layers<B>(c, *m.average_encoder, m.average_encoder->sequence(x), 0);
  } else {
    ml::load_module(*m.encoder, c.file(), "weights/");
    embedded(*m.encoder);
    encoder_layers<B>(c, *m.encoder, m.encoder->sequence(x, y), 2);
  }
  const auto latent = m.encode(x, y, {}, c.shape("in/x")[3]);
  golden::out(c, "mu", latent.mu);
  golden::out(c, "logvar", latent.logvar);
}

template <ml::Backend B>
void decoder_forward(Case& c) {
  const auto config = golden::actor_config(c);
  auto m = empty_model<B>(config);
  ml::load_module(*m.decoder, c.file(), "weights/");
  const auto z = tensor<B, 2>(c, "in/z");
  const auto y = c.values<Index>("in/y");
  const auto lengths = golden::offsets_of(c);
  const Index frames = c.shape("in/mask")[1];
  const auto memory = m.decoder->memory(z, y);
  auto h = m.decoder->queries(lengths);
  auto out = [&](const char* name, const ml::Tensor<B, 2>& rows) {
    golden::out_if_wanted(c, name, golden::time_first(h.with(rows), frames));
  };
  const auto& layers = m.decoder->seqTransDecoder.layers;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const auto self = layers[i].attend_self(h.rows, lengths);
    if (i == 0) {
      out("layer_0_self", self);
      out("layer_0_cross", layers[i].attend_memory(self, lengths, memory));
    }
    h.rows = layers[i](h.rows, lengths, memory);
    if (i == 0) out("layer_0", h.rows);
    if (i + 1 == layers.size()) out("layer_last", h.rows);
  }
  golden::out(c, "output", golden::motion_layout(m.decode(z, y, lengths), config.nfeats, frames));
}

template <ml::Backend B>
void autoencoder_forward(Case& c) {
  const auto config = golden::actor_config(c);
  const auto m = golden::loaded(c, empty_model<B>(config));
  const auto x = golden::motions<B>(c);
  const auto y = c.values<Index>("in/y");
  const auto latent = m.encode(x, y, {}, c.shape("in/x")[3]);
  const auto z = latent.sample(tensor<B, 2>(c, "noise/eps"));
  golden::out(c, "mu", latent.mu);
  golden::out(c, "logvar", latent.logvar);
  golden::out(c, "z", z);
  golden::out(c, "output", golden::motion_layout(m.decode(z, y, x.offsets), config.nfeats, c.shape("in/x")[3]));
}

ml::NoiseSharing sharing(const std::string& name) {
  return name == "random" ? ml::NoiseSharing::random
         : name == "same" ? ml::NoiseSharing::same
                          : ml::NoiseSharing::interpolate;
}

/// Gives the numbers of a case instead of drawing them.
struct GivenNoise {
  const Case& c;
  template <class S>
  void normal(std::span<S> out) {
    const auto values = c.values<S>("noise/000");
    if (values.size() != out.size()) throw std::runtime_error("the case has another number of noise values");
    std::copy(values.begin(), values.end(), out.begin());
  }
};

template <ml::Backend B>
void generation(Case& c) {
  const auto json = c.config();
  const auto config = golden::actor_config(c);
  auto m = empty_model<B>(config);
  ml::load_module(*m.decoder, c.file(), "weights/decoder.");
  const ml::ActorSampling o{.samples = json["nspa"].as<Index>(),
                            .across_samples = sharing(json["noise_same_action"].as<std::string>()),
                            .across_actions = sharing(json["noise_diff_action"].as<std::string>()),
                            .fact = json["fact"].as<double>()};
  const auto classes = c.values<Index>("in/classes"), durations = c.values<Index>("in/durations");
  const auto actions = std::ssize(classes);
  const auto noise = tensor<B, 2>(c, "noise/000");
  golden::out(c, "z", ml::actor_latents(noise, actions, o));
  GivenNoise given{c};
  const auto motions = ml::generate(m, classes, durations, given, o);
  std::vector<Index> labels, lengths;
  for (Index i = 0; i < motions.count(); ++i) {
    labels.push_back(classes[static_cast<std::size_t>(i % actions)]);
    lengths.push_back(motions.offsets.length(i));
  }
  const Index frames = motions.offsets.longest();
  c.out("y", labels);
  c.out("lengths", lengths);
  c.out("mask", {motions.count(), frames}, ml::lengths_to_mask(lengths));
  golden::out(c, "output", golden::motion_layout(motions, config.nfeats, frames));
  if (std::is_same_v<typename B::scalar, float> && json.contains("seed")) {  // the same from the seed, as PyTorch draws
    auto torch = golden::seeded<ml::TorchRandom>(json["seed"]);
    const auto drawn = ml::generate(m, classes, durations, torch, o);
    for (std::size_t i = 0; i < drawn.rows.span().size(); ++i) {
      const auto got = drawn.rows.span()[i], want = motions.rows.span()[i];
      if (std::abs(got - want) > 1e-4 * (1 + std::abs(want)))
        throw std::runtime_error("another motion from the seed than from the noise");
    }
  }
}

template <ml::Backend B>
void gru_encoder(Case& c) {
  auto config = golden::actor_config(c);
  config.encoder = ml::ActorEncoderKind::gru;
  config.decoder = ml::ActorDecoderKind::gru;  // no transformer, which wants an even width
  auto m = empty_model<B>(config);
  ml::load_module(*m.gru_encoder, c.file(), "weights/");
  const auto latent = m.encode(golden::motions<B>(c), c.values<Index>("in/y"));
  golden::out(c, "mu", latent.mu);
  golden::out(c, "logvar", latent.logvar);
}

template <ml::Backend B>
void gru_decoder(Case& c) {
  auto config = golden::actor_config(c);
  config.encoder = ml::ActorEncoderKind::gru;
  config.decoder = ml::ActorDecoderKind::gru;
  auto m = empty_model<B>(config);
  ml::load_module(*m.gru_decoder, c.file(), "weights/");
  const auto x = m.decode(tensor<B, 2>(c, "in/z"), c.values<Index>("in/y"), golden::offsets_of(c));
  golden::out(c, "output", golden::motion_layout(x, config.nfeats, c.shape("in/mask")[1]));
}

template <ml::Backend B>
void autoregressive_decoder(Case& c) {
  auto config = golden::actor_config(c);
  config.decoder = ml::ActorDecoderKind::autoregressive;
  auto m = empty_model<B>(config);
  ml::load_module(*m.autoregressive_decoder, c.file(), "weights/");
  const auto z = tensor<B, 2>(c, "in/z");
  const auto y = c.values<Index>("in/y");
  const auto x = c.config()["teacher_forcing"].as<bool>() ? m.teach(z, y, golden::motions<B>(c))
                                                          : m.decode(z, y, golden::offsets_of(c));
  golden::out(c, "output", golden::motion_layout(x, config.nfeats, c.shape("in/mask")[1]));
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"actor encoder forward", variant, encoder_forward<B>},
          {"actor decoder forward", variant, decoder_forward<B>},
          {"actor autoencoder forward", variant, autoencoder_forward<B>},
          {"actor generation", variant, generation<B>},
          {"actor gru encoder forward", variant, gru_encoder<B>},
          {"actor gru decoder forward", variant, gru_decoder<B>},
          {"actor autoregressive decoder forward", variant, autoregressive_decoder<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
