// Checkpoints of TEACH and SINC: sizes from shapes, options, what is skipped, what is refused.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/teach_sinc_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/file_of_model.hpp"
#include "../../support/small_teach_sinc.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using models::file_of;
using tensors::same_bits;
namespace small = small_teach_sinc;

TEST_CASE("TEACH: with and without what only some checkpoints have; heads and past from the options") {
  auto c = small::teach_config;
  c.max_len = 5000;
  c.z_prev_text = true;
  ml::RunFolder run;
  run.options = {
      {"model/num_heads", std::int64_t{2}}, {"model/hist_frames", std::int64_t{2}}, {"model/z_prev_text", true}};
  for (bool all : {true, false}) {
    c.motion_encoder = c.unused_encoder = all;
    const auto model = small::teach<B>(c);
    const auto file = file_of(model, {"textencoder.sequence_pos_encoding.pe", "textencoder.text_model.embeddings.x",
                                      "_losses.losses_train.total"});
    const auto loaded = ml::teach_network<B>(file, run);
    CHECK(loaded.config == c);
    const ml::TeachPast<B> past{small::sequences<B>({2, 2}, 135, 1), tensors::normal<B, 2>({2, 8}, 2)};
    const auto text = small::sequences<B>({3, 1}, 5, 3);
    CHECK(same_bits(loaded.encode_text(text, past).mu, model.encode_text(text, past).mu));
    const auto usual = ml::teach_network<B>(file).config;
    CHECK(usual.num_heads == 4);
    CHECK(usual.hist_frames == 5);
    CHECK_FALSE(usual.z_prev_text);
  }
  CHECK_ERROR(ml::teach_network<B>(file_of(small::sinc<B>())), "[motionlang.io.406]");
}

TEST_CASE("SINC") {
  const auto model = small::sinc<B>(ml::SincMode::separate_latents);
  ml::RunFolder run;
  run.options = {{"model/num_heads", std::int64_t{2}}};
  const auto file = file_of(model, {"eval_model.motionencoder.mu_token", "metrics.count"});
  const auto loaded = ml::sinc_network<B>(file, run, ml::SincMode::separate_latents);
  auto c = model.config;
  c.max_len = 5000;
  CHECK(loaded.config == c);
  CHECK(same_bits(loaded.encode_text(small::texts<B>()).mu, model.encode_text(small::texts<B>()).mu));
  CHECK(ml::sinc_network<B>(file).config.mode == ml::SincMode::single);
  CHECK_ERROR(ml::sinc_network<B>(file_of(model, {"textencoder.skel_embedding.weight"})), "[motionlang.io.406]");
}

TEST_CASE("a file that is too small for a network of its sizes is refused before memory is taken") {
  const auto file = models::file_of_shapes({{"motiondecoder.final_layer.weight", {2, 1}},
                                            {"textencoder.projection.1.weight", {70'000, 1}},
                                            {"textencoder.seqTransEncoder.layers.0.linear1.weight", {2, 1}}});
  CHECK_ERROR(ml::teach_network<B>(file), "[motionlang.config.102] model.ckpt: 70004 numbers");
  CHECK_ERROR(ml::sinc_network<B>(file), "[motionlang.config.102] model.ckpt: 70004 numbers");
}
