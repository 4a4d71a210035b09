// Names, shapes and numbers of parameters of TEMOS and TMR at their published sizes. Source: written
// down from the checkpoints of Mathux/TEMOS and Mathux/TMR.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/systems/temos.hpp>
#include <motionlang/systems/tmr.hpp>

#include <doctest/doctest.h>

#include "../../support/state_dict_keys.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;
using keys::Keys, keys::keys_of;

namespace {

Keys temos_text_keys() {
  Keys k;
  for (const char* token : {"mu_token", "logvar_token"}) k.add(std::string("textencoder.") + token, {256});
  k.linear("textencoder.projection.1", 256, 768);
  k.transformer("textencoder.seqTransEncoder.layers.{6}", 256, 1024);
  return k;
}

}  // namespace

TEST_CASE("TEMOS") {
  ml::NoInit zeros;
  SUBCASE("joints and rotations") {
    for (Index p : {64, 135}) {
      const ml::Temos<B> model({.nfeats = p}, zeros);
      auto k = temos_text_keys();
      for (const char* token : {"mu_token", "logvar_token"}) k.add(std::string("motionencoder.") + token, {256});
      k.linear("motionencoder.skel_embedding", 256, p);
      k.transformer("motionencoder.seqTransEncoder.layers.{6}", 256, 1024);
      k.transformer_decoder("motiondecoder.seqTransDecoder.layers.{6}", 256, 1024);
      k.linear("motiondecoder.final_layer", p, 256);
      CHECK(keys_of(model).shapes == k.shapes);
      if (p != 64) continue;
      CHECK(ml::parameter_count(model.textencoder) == 4'935'936);
      CHECK(ml::parameter_count(*model.motionencoder) == 4'755'712);
      CHECK(ml::parameter_count(*model.motiondecoder) == 6'337'088);
    }
  }
  SUBCASE("recurrent networks") {
    const ml::Temos<B> model({.motion_encoder = ml::TemosNetwork::gru, .motion_decoder = ml::TemosNetwork::gru}, zeros);
    auto k = temos_text_keys();
    k.linear("motionencoder.skel_embedding", 256, 64);
    k.linear("motionencoder.mu", 256, 256);
    k.linear("motionencoder.logvar", 256, 256);
    k.linear("motiondecoder.emb_layer", 256, 257);
    k.linear("motiondecoder.final_layer", 64, 256);
    for (const std::string module : {"motionencoder", "motiondecoder"}) {
      for (const char* weight : {".gru.weight_ih_l{6}", ".gru.weight_hh_l{6}"}) k.add(module + weight, {768, 256});
      for (const char* bias : {".gru.bias_ih_l{6}", ".gru.bias_hh_l{6}"}) k.add(module + bias, {768});
    }
    CHECK(keys_of(model).shapes == k.shapes);
  }
  SUBCASE("deterministic, and without motion encoder") {
    const auto shapes = keys_of(ml::Temos<B>({.vae = false, .motion_encoder = ml::TemosNetwork::none}, zeros)).shapes;
    CHECK(shapes.at("textencoder.emb_token") == "(256)");
    CHECK(shapes.count("textencoder.mu_token") == 0);
    CHECK(shapes.lower_bound("motionencoder.") == shapes.lower_bound("motionencoder/"));
    const auto recurrent = keys_of(ml::Temos<B>({.vae = false, .motion_encoder = ml::TemosNetwork::gru}, zeros)).shapes;
    CHECK(recurrent.at("motionencoder.final.weight") == "(256, 256)");
    CHECK(recurrent.count("motionencoder.mu.weight") == 0);
  }
}

TEST_CASE("TMR") {
  ml::NoInit zeros;
  const ml::Tmr<B> model({}, zeros);
  Keys k;
  for (const auto& [module, nfeats] : {std::pair{"motion_encoder", 263}, {"text_encoder", 768}}) {
    const std::string name = module;
    k.add(name + ".tokens", {2, 256});
    k.linear(name + ".projection", 256, nfeats);
    k.transformer(name + ".seqTransEncoder.layers.{6}", 256, 1024);
  }
  k.transformer_decoder("motion_decoder.seqTransDecoder.layers.{6}", 256, 1024);
  k.linear("motion_decoder.final_layer", 263, 256);
  CHECK(keys_of(model).shapes == k.shapes);
  CHECK(k.shapes.size() == 260);
  CHECK(ml::parameter_count(model.motion_encoder) == 4'806'656);
  CHECK(ml::parameter_count(model.text_encoder) == 4'935'936);
  CHECK(ml::parameter_count(model.motion_decoder) == 6'388'231);
  CHECK(ml::parameter_count(model) == 16'130'823);
  CHECK(keys_of(ml::Tmr<B>({.vae = false}, zeros)).shapes.at("text_encoder.tokens") == "(1, 256)");
}
