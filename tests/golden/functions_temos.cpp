// Golden functions: the networks of TEMOS, sampling, motions from texts.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/core/torch_random.hpp>
#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/vae/temos_gru.hpp>

#include "seeds.hpp"
#include "text_motion.hpp"

namespace {

using golden::Case, golden::Layout, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B, class Keys>
void encoder_forward(Case& c) {
  const auto config = c.config();
  constexpr bool text = Keys::relu;
  ml::Philox rng;
  ml::TemosEncoder<B, Keys> m(config[text ? "text_dim" : "nfeats"].template as<Index>(), golden::variational(config),
                              golden::transformer_of(config), golden::position_rows, rng);
  ml::load_module(m, c.file(), "weights/");
  const auto x = golden::packed<B>(c, text ? "x" : "features", "mask");
  const Index frames = golden::padded_frames(c);
  golden::out_padded(c, text ? "projected" : "embedded", m.embed(x), frames, Layout::batch_first);
  golden::out_encoder_layers(c, m.seqTransEncoder, m.sequence(x), frames + (golden::variational(config) ? 2 : 1),
                             Layout::time_first);
  golden::out_latent(c, m(x));
}

template <ml::Backend B>
void decoder_forward(Case& c) {
  golden::decoder_forward<B>(c, Layout::time_first, "features");
}

template <ml::Backend B>
void gru_encoder_forward(Case& c) {
  const auto config = c.config();
  ml::Philox rng;
  ml::TemosGruEncoder<B> m(config["nfeats"].template as<Index>(), golden::variational(config),
                           config["latent_dim"].template as<Index>(), config["num_layers"].template as<Index>(), rng);
  ml::load_module(m, c.file(), "weights/");
  const auto lengths = c.values<Index>("in/lengths");
  golden::out_latent(c, m(ml::from_padded(tensor<B, 3>(c, "in/features"), std::span<const Index>(lengths))));
}

template <ml::Backend B>
void gru_decoder_forward(Case& c) {
  const auto config = c.config();
  ml::Philox rng;
  ml::TemosGruDecoder<B> m(config["nfeats"].template as<Index>(), config["latent_dim"].template as<Index>(),
                           config["num_layers"].template as<Index>(), rng);
  ml::load_module(m, c.file(), "weights/");
  golden::out(c, "features", ml::to_padded(m(tensor<B, 2>(c, "in/z"), golden::lengths_of(c))));
}

/// The numbers are drawn as PyTorch draws them after the seed, if there is one.
template <ml::Backend B>
void latent_sampling(Case& c) {
  const auto shape = c.shape("in/mu");
  std::vector<float> eps(static_cast<std::size_t>(shape.count()));
  const auto config = c.config();
  if (config.contains("seed") && !config["seed"].is_null()) {
    golden::seeded<ml::TorchRandom>(config["seed"]).normal(std::span<float>(eps));
  } else {
    eps = c.values<float>("noise/eps");
  }
  const ml::LatentGaussian<B> g{tensor<B, 2>(c, "in/mu"), log(tensor<B, 2>(c, "in/std")) * 2.0};
  const auto noise = ml::Tensor<B, 2>::from(std::vector<typename B::scalar>(eps.begin(), eps.end()), shape);
  golden::out(c, "z", g.sample(noise, c.config().value_or("fact", 1.0)));
}

template <ml::Backend B>
void text_to_motion(Case& c) {
  using S = typename B::scalar;
  const auto config = c.config();
  const auto m = golden::temos_model<B>(c);
  const auto latent = m.encode_text(golden::packed<B>(c, "text_x", "text_mask"));
  const auto z = latent.sample(golden::noise<B>(c, "eps"), config.value_or("fact", 1.0));
  golden::out_latent(c, latent);
  golden::out(c, "z", z);
  const auto lengths = golden::lengths_of(c);
  const auto features = ml::to_padded(m.decode(z, lengths));
  golden::out(c, "features", features);
  const ml::Normalizer<B> normalizer{tensor<B, 1>(c, "in/mean"), tensor<B, 1>(c, "in/std")};
  const Index frames = features.size(1), width = features.size(2);
  std::vector<S> all;
  for (Index i = 0; i < lengths.count(); ++i) {
    std::vector<S> joints;
    for (const auto& p :
         ml::temos_joints(normalizer, ml::reshape<2>(ml::slice(features, 0, i, i + 1), {frames, width})))
      joints.insert(joints.end(), {p.x, p.y, p.z});
    all.insert(all.end(), joints.begin(), joints.end());
    const Index numbers = std::ssize(joints) / frames;
    const auto smooth = ml::upsample_linearly(
        std::span<const S>(joints).first(static_cast<std::size_t>(lengths.length(i) * numbers)), numbers,
        config["framerate"].template as<double>(), config["new_framerate"].template as<double>());
    c.out("sequence_" + std::to_string(i), {std::ssize(smooth) / numbers, numbers / 3, 3}, smooth);
  }
  c.out("joints", c.shape("out/joints"), all);
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"temos text encoder forward", variant, encoder_forward<B, ml::TemosTextKeys>},
          {"temos motion encoder forward", variant, encoder_forward<B, ml::TemosMotionKeys>},
          {"temos motion decoder forward", variant, decoder_forward<B>},
          {"temos gru motion encoder forward", variant, gru_encoder_forward<B>},
          {"temos gru motion decoder forward", variant, gru_decoder_forward<B>},
          {"temos latent sampling", variant, latent_sampling<B>},
          {"temos text to motion", variant, text_to_motion<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
