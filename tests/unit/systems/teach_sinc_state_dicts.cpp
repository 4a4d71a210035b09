// Names, shapes and numbers of parameters of TEACH and SINC at their published sizes. Source: written
// down from the checkpoints of TEACH and SINC.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/systems/sinc.hpp>
#include <motionlang/systems/teach.hpp>

#include <doctest/doctest.h>

#include "../../support/state_dict_keys.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using keys::Keys, keys::keys_of;

namespace {

/// `separation`: how the system spells it.
Keys common_keys(const std::string& separation) {
  Keys k;
  for (const std::string& token : {std::string("mu_token"), std::string("logvar_token"), separation})
    k.add("textencoder." + token, {256});
  k.linear("textencoder.projection.1", 256, 768);
  k.transformer("textencoder.seqTransEncoder.layers.{6}", 256, 1024);
  for (const char* token : {"mu_token", "logvar_token"}) k.add(std::string("motionencoder.") + token, {256});
  k.linear("motionencoder.skel_embedding", 256, 135);
  k.transformer("motionencoder.seqTransEncoder.layers.{6}", 256, 1024);
  k.transformer_decoder("motiondecoder.seqTransDecoder.layers.{6}", 256, 1024);
  k.linear("motiondecoder.final_layer", 135, 256);
  return k;
}

}  // namespace

TEST_CASE("TEACH") {
  ml::NoInit zeros;
  auto k = common_keys("seperation_token");
  k.linear("textencoder.skel_embedding", 256, 135);
  const ml::Teach<B> model({}, zeros);
  CHECK(keys_of(model).shapes == k.shapes);
  CHECK(ml::parameter_count(model.textencoder) == 4'971'008);
  CHECK(ml::parameter_count(*model.motionencoder) == 4'773'888);
  CHECK(ml::parameter_count(model.motiondecoder) == 6'355'335);

  const ml::Teach<B> published({.unused_encoder = true}, zeros);
  k.transformer("textencoder.motionTransEncoder.layers.{6}", 256, 1024);
  CHECK(keys_of(published).shapes == k.shapes);
  CHECK(ml::parameter_count(published.textencoder) == 9'709'568);
}

TEST_CASE("SINC") {
  ml::NoInit zeros;
  const ml::Sinc<B> model({}, zeros);
  CHECK(keys_of(model).shapes == common_keys("separation_token").shapes);
  CHECK(ml::parameter_count(model.textencoder) == 4'936'192);
  CHECK(ml::parameter_count(*model.motionencoder) == 4'773'888);
  CHECK(ml::parameter_count(model.motiondecoder) == 6'355'335);
  CHECK(keys_of(ml::Sinc<B>({.motion_encoder = false}, zeros)).shapes.count("motionencoder.mu_token") == 0);
}
