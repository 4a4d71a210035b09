// The names, shapes and numbers of parameters of the published models, at their published sizes.
// Source: written down from the checkpoints of nv-tlabs/stmc, MDM and MotionDiffuse.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/diffusion/mdm.hpp>
#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/diffusion/motiondiffuse.hpp>

#include <doctest/doctest.h>

#include "../../support/state_dict_keys.hpp"

namespace ml = motionlang;
using ml::Index, ml::Shape;
using B = ml::EigenBackend<float>;
using keys::Keys, keys::keys_of;

namespace {

Keys mdm_keys(Index frame_input = 263) {
  Keys k;
  k.linear("input_process.poseEmbedding", 512, frame_input);
  k.linear("embed_timestep.time_embed.0", 512, 512);
  k.linear("embed_timestep.time_embed.2", 512, 512);
  k.linear("embed_text", 512, 512);
  k.linear("output_process.poseFinal", 263, 512);
  return k;
}

}  // namespace

TEST_CASE("MDM-SMPL") {
  ml::NoInit zeros;
  const ml::MdmSmplDenoiser<B> model({}, zeros);
  Keys k;
  k.add("registers", {2, 512});
  k.linear("tx_embedding.0", 1024, 512);
  k.linear("tx_embedding.2", 512, 1024);
  k.norm("tx_embedding.3", 512);
  k.linear("skel_embedding", 512, 205);
  k.linear("timestep_encoder.time_embed.0", 512, 512);
  k.linear("timestep_encoder.time_embed.2", 512, 512);
  k.transformer("seqTransEncoder.layers.{8}", 512, 2048);
  k.linear("to_skel_layer", 205, 512);
  CHECK(keys_of(model).shapes == k.shapes);
  CHECK(k.shapes.size() == 115 - 4);  // without the statistics of motion and text
  CHECK(ml::parameter_count(model) == 27'007'181);
}

TEST_CASE("MDM") {
  ml::NoInit zeros;
  SUBCASE("encoder") {
    const ml::MdmDenoiser<B> model({}, zeros);
    auto k = mdm_keys();
    k.transformer("seqTransEncoder.layers.{8}", 512, 1024);
    CHECK(keys_of(model).shapes == k.shapes);
    CHECK(k.shapes.size() == 108 - 2);  // without the two position tables
    CHECK(ml::parameter_count(model) == 17'880'327);
  }
  SUBCASE("decoder") {
    const ml::MdmDenoiser<B> model({.arch = ml::MdmArch::trans_dec}, zeros);
    auto k = mdm_keys();
    k.transformer_decoder("seqTransDecoder.layers.{8}", 512, 1024);
    CHECK(keys_of(model).shapes == k.shapes);
    CHECK(k.shapes.size() == 156 - 2);
    CHECK(ml::parameter_count(model) == 26'293'511);
  }
  SUBCASE("gru") {
    const ml::MdmDenoiser<B> model({.arch = ml::MdmArch::gru}, zeros);
    auto k = mdm_keys(775);
    for (const char* weight : {"gru.weight_ih_l{8}", "gru.weight_hh_l{8}"}) k.add(weight, {1536, 512});
    for (const char* bias : {"gru.bias_ih_l{8}", "gru.bias_hh_l{8}"}) k.add(bias, {1536});
    CHECK(keys_of(model).shapes == k.shapes);
    CHECK(k.shapes.size() == 44 - 2);
    CHECK(ml::parameter_count(model) == 13'927'687);
  }
  SUBCASE("actions") {
    const ml::MdmDenoiser<B> model({.nfeats = 150, .condition = ml::MdmCondition::action, .num_actions = 12}, zeros);
    const auto shapes = keys_of(model).shapes;
    CHECK(shapes.at("embed_action.action_embedding") == "(12, 512)");
    CHECK(shapes.count("embed_text.weight") == 0);
  }
}

TEST_CASE("MotionDiffuse") {
  ml::NoInit zeros;
  const ml::MotionDiffuseDenoiser<B> model({}, zeros);
  Keys k;
  k.add("sequence_embedding", {196, 512});
  k.linear("text_pre_proj", 256, 512);
  k.transformer("textTransEncoder.layers.{4}", 256, 2048);
  k.norm("text_ln", 256);
  k.linear("text_proj.0", 2048, 256);
  k.linear("joint_embed", 512, 263);
  k.linear("time_embed.0", 2048, 512);
  k.linear("time_embed.2", 2048, 2048);
  const std::string block = "temporal_decoder_blocks.{8}.";
  for (const char* part : {"sa_block", "ca_block"}) {
    const Index source = std::string_view(part) == "sa_block" ? 512 : 256;
    k.norm(block + part + ".norm", 512);
    k.linear(block + part + ".query", 512, 512);
    k.linear(block + part + ".key", 512, source);
    k.linear(block + part + ".value", 512, source);
  }
  k.norm(block + "ca_block.text_norm", 256);
  k.linear(block + "ffn.linear1", 1024, 512);
  k.linear(block + "ffn.linear2", 512, 1024);
  for (const char* part : {"sa_block", "ca_block", "ffn"}) {
    k.linear(block + part + ".proj_out.emb_layers.1", 1024, 2048);
    k.norm(block + part + ".proj_out.norm", 512);
    k.linear(block + part + ".proj_out.out_layers.2", 512, 512);
  }
  k.linear("out", 263, 512);
  CHECK(keys_of(model).shapes == k.shapes);
  CHECK(k.shapes.size() == 685 - 302);  // without CLIP
  CHECK(ml::parameter_count(model) == 87'152'135);
}
