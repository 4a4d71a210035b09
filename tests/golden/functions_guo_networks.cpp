// Golden functions: the networks of Guo's evaluator.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/metrics/guo_movement.hpp>

#include "guo_models.hpp"

namespace {

using golden::Case, golden::Registration, golden::tensor;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
void movement_encoder(Case& c) {
  const auto config = c.config();
  ml::Philox rng;
  ml::MovementEncoder<B> m(config["input"].as<Index>(), config["hidden"].as<Index>(), config["latent"].as<Index>(),
                           rng);
  ml::load_module(m, c.file(), "weights/");
  const auto x = ml::from_equal(tensor<B, 3>(c, "in/x"));
  golden::out(c, "latent", ml::to_padded(m(x)));
}

template <ml::Backend B>
void text_encoder(Case& c) {
  const auto config = c.config();
  ml::Philox rng;
  ml::GuoTextEncoder<B> m(config["word"].as<Index>(), config["pos"].as<Index>(), config["hidden"].as<Index>(),
                          config["output"].as<Index>(), rng);
  ml::load_module(m, c.file(), "weights/");
  golden::out(c, "embedding", m(golden::words<B>(c, "lengths")));
}

template <ml::Backend B>
void motion_encoder(Case& c) {
  const auto config = c.config();
  ml::Philox rng;
  ml::GuoMotionEncoder<B> m(config["input"].as<Index>(), config["hidden"].as<Index>(), config["output"].as<Index>(),
                            rng);
  ml::load_module(m, c.file(), "weights/");
  golden::out(c, "embedding", m(golden::packed_rows<B>(c, "movements", "lengths")));
}

template <ml::Backend B>
void co_embeddings(Case& c) {
  const auto both = golden::embeddings(c, golden::evaluator<B>(c));
  golden::out(c, "text", both.text);
  golden::out(c, "motion", both.motion);
  golden::out(c, "motion_only", both.motion);
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"guo movement encoder", variant, movement_encoder<B>},
          {"guo text encoder", variant, text_encoder<B>},
          {"guo motion encoder", variant, motion_encoder<B>},
          {"guo co-embeddings", variant, co_embeddings<B>}};
}
const auto reference = over<ml::ReferenceBackend<double>>("reference<double>");
const auto eigen = over<ml::EigenBackend<float>>("eigen<float>");
const auto xtensor = over<ml::XtensorBackend<float>>("xtensor<float>");

}  // namespace
