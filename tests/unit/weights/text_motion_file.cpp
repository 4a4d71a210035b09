// Checkpoints of TEMOS and TMR: sizes from shapes, options, what is skipped, what is refused.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/text_motion_file.hpp>
#include <motionlang/weights/tmr_checkpoint.hpp>

#include "../../support/check_error.hpp"
#include "../../support/file_of_model.hpp"
#include "../../support/small_text_motion.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using models::file_of;
using tensors::same_bits;
namespace small = small_text_motion;

TEST_CASE("TEMOS: the variants are known by their tensors; tables, language model and sums of losses are skipped") {
  auto c = small::temos_config;
  c.num_heads = 4;
  c.max_len = 5000;
  for (int variant = 0; variant < 4; ++variant) {
    c.vae = variant != 1;
    c.motion_encoder = variant == 2   ? ml::TemosNetwork::gru
                       : variant == 3 ? ml::TemosNetwork::none
                                      : ml::TemosNetwork::transformer;
    c.motion_decoder = variant == 2 ? ml::TemosNetwork::gru : ml::TemosNetwork::transformer;
    const auto model = small::temos<B>(c);
    const auto loaded = ml::temos_network<B>(
        file_of(model, {"motiondecoder.sequence_pos_encoding.pe", "textencoder.sequence_pos_encoding.pe",
                        "textencoder.text_model.embeddings.LayerNorm.bias", "_losses.losses_train.total"}));
    CHECK(loaded.config == c);
    const auto mu = model.encode_text(small::texts<B>()).mu;
    CHECK(same_bits(loaded.encode_text(small::texts<B>()).mu, mu));
    CHECK(same_bits(loaded.decode(mu, ml::Offsets{3, 1, 2}).rows, model.decode(mu, ml::Offsets{3, 1, 2}).rows));
  }
}

TEST_CASE("TMR") {
  auto c = small::tmr_config;
  c.num_heads = 4;
  c.max_len = 5000;
  for (bool vae : {true, false}) {
    c.vae = vae;
    const auto model = small::tmr<B>(c);
    const auto loaded = ml::tmr_network<B>(file_of(model, {"stats.mean", "stats.std"}));
    CHECK(loaded.config == c);
    CHECK(same_bits(loaded.encode_motion(small::motions<B>(263)).mu, model.encode_motion(small::motions<B>(263)).mu));
  }
}

TEST_CASE("what is not of the model is refused") {
  const auto model = small::tmr<B>();
  CHECK_ERROR(ml::tmr_network<B>(file_of(model, {"motion_encoder.extra"})), "[motionlang.io.406]");
  CHECK_ERROR(ml::tmr_network<B>(file_of(model.text_encoder)), "[motionlang.io.406]");
  CHECK_ERROR(ml::temos_network<B>(file_of(model)), "[motionlang.io.406]");
}

TEST_CASE("a file that is too small for a network of its sizes is refused before memory is taken") {
  const ml::Index huge = 70'000;
  CHECK_ERROR(
      ml::tmr_network<B>(models::file_of_shapes({{"motion_encoder.projection.weight", {huge, 1}},
                                                 {"motion_encoder.seqTransEncoder.layers.0.linear1.weight", {2, 1}},
                                                 {"motion_encoder.tokens", {2, 1}},
                                                 {"text_encoder.projection.weight", {2, 1}}})),
      "[motionlang.config.102] model.ckpt: 70006 numbers, a network of its sizes has at least 147");
  CHECK_ERROR(
      ml::temos_network<B>(models::file_of_shapes({{"motiondecoder.final_layer.weight", {2, 1}},
                                                   {"textencoder.projection.1.weight", {huge, 1}},
                                                   {"textencoder.seqTransEncoder.layers.0.linear1.weight", {2, 1}}})),
      "[motionlang.config.102] model.ckpt: 70004 numbers");
}

TEST_CASE("options of a run say how many heads there are, and have to agree with the tensors") {
  const auto model = small::tmr<B>();
  ml::RunFolder run;
  run.options = {{"model/motion_encoder/num_heads", std::int64_t{2}}};
  CHECK(ml::tmr_network<B>(file_of(model), run).config.num_heads == 2);
  run.options = {{"model/motion_encoder/num_heads", std::int64_t{3}}};
  CHECK_ERROR(ml::tmr_network<B>(file_of(model), run), "[motionlang.config.101]");
  run.options = {{"model/text_encoder/nfeats", std::int64_t{768}}};
  CHECK_ERROR(ml::tmr_network<B>(file_of(model), run), "[motionlang.config.102]");
  run.options = {{"model/num_head", std::int64_t{6}}};  // as TEMOS' options have it, and its code does not read
  CHECK(ml::temos_network<B>(file_of(small::temos<B>()), run).config.num_heads == 4);
}
