// Golden functions: the networks of TMR, and what is computed from their inputs and latents.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/vae/tmr_encoder.hpp>

#include "text_motion.hpp"

namespace {

using golden::Case, golden::Layout, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
void encoder_forward(Case& c) {
  const auto config = c.config();
  ml::Philox rng;
  ml::TmrEncoder<B> m(config["nfeats"].template as<Index>(), golden::variational(config),
                      golden::transformer_of(config), golden::position_rows, rng);
  ml::load_module(m, c.file(), "weights/");
  const auto x = golden::packed<B>(c, "x", "mask");
  const Index frames = golden::padded_frames(c);
  golden::out_padded(c, "projected", m.projection(x), frames, Layout::batch_first);
  golden::out_encoder_layers(c, m.seqTransEncoder, m.sequence(x), frames + m.tokens.size(0), Layout::batch_first);
  golden::out_latent(c, m(x));
}

template <ml::Backend B>
void decoder_forward(Case& c) {
  golden::decoder_forward<B>(c, Layout::batch_first, "motion");
}

template <ml::Backend B>
void similarity(Case& c) {
  const auto s = ml::cosine_similarity(tensor<B, 2>(c, "in/x"), tensor<B, 2>(c, "in/y"));
  golden::out(c, "similarity", s);
  golden::out(c, "score", ml::tmr_score(s));
}

template <ml::Backend B>
void sentence_pooling(Case& c) {
  golden::out(c, "embedding", ml::normalize_rows(ml::mean_rows(golden::packed<B>(c, "x", "mask"))));
}

template <ml::Backend B>
void collate(Case& c) {
  std::vector<ml::Tensor<B, 2>> items;
  std::vector<Index> lengths;
  for (Index i = 0; c.has("in/x_" + std::to_string(i)); ++i) {
    items.push_back(tensor<B, 2>(c, "in/x_" + std::to_string(i)));
    lengths.push_back(items.back().size(0));
  }
  const ml::Sequences<B> all(ml::concat(std::span<const ml::Tensor<B, 2>>(items), 0), ml::Offsets(lengths));
  golden::out(c, "x", ml::to_padded(all));
  c.out("mask", c.shape("out/mask"), ml::lengths_to_mask(lengths));
  c.out("length", lengths);
}

template <ml::Backend B>
void normalization(Case& c) {
  const ml::Normalizer<B> n{tensor<B, 1>(c, "in/mean"), tensor<B, 1>(c, "in/std"), c.config()["eps"].as<double>()};
  const auto normalized = n.normalize(tensor<B, 2>(c, "in/x"));
  golden::out(c, "normalized", normalized);
  golden::out(c, "restored", n.denormalize(normalized));
}

template <ml::Backend B>
void encode(Case& c) {
  const auto m = golden::tmr_model<B>(c);
  const double fact = c.config().value_or("fact", 1.0);
  const auto text = m.encode(golden::packed<B>(c, "text_x", "text_mask")),
             motion = m.encode(golden::packed<B>(c, "motion_x", "motion_mask"));
  golden::out(c, "text_mean", text.mu);
  golden::out(c, "motion_mean", motion.mu);
  golden::out(c, "text_sample", text.sample(golden::noise<B>(c, "eps_text"), fact));
  golden::out(c, "motion_sample", motion.sample(golden::noise<B>(c, "eps_motion"), fact));
  const auto s = ml::cosine_similarity(text.mu, motion.mu);
  golden::out(c, "similarity", s);
  golden::out(c, "score", ml::tmr_score(s));
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"tmr encoder forward", variant, encoder_forward<B>},
          {"tmr decoder forward", variant, decoder_forward<B>},
          {"tmr encode", variant, encode<B>},
          {"tmr similarity", variant, similarity<B>},
          {"tmr sentence pooling", variant, sentence_pooling<B>},
          {"tmr collate", variant, collate<B>},
          {"tmr normalization", variant, normalization<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
