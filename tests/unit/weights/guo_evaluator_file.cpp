// The checkpoint of Guo's evaluator: sizes from shapes, what is skipped, what is refused.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/guo_evaluator_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/file_of_model.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using models::file_of;
using tensors::normal, tensors::same_bits;

TEST_CASE("Guo's evaluator: sizes are those of the tensors, optimisers are skipped") {
  ml::Philox rng{.seed = 8};
  const ml::GuoEvaluator<B> model({.features = 15,
                                   .movement_hidden = 6,
                                   .movement_latent = 5,
                                   .word = 4,
                                   .pos = 3,
                                   .text_hidden = 7,
                                   .motion_hidden = 8,
                                   .embedding = 9},
                                  rng);
  const auto loaded = ml::load_guo_evaluator<B>(file_of(model, {"opt_text_encoder.state.0.exp_avg"}));
  const ml::Sequences<B> motions(normal<B, 2>({24, 15}, 1), ml::Offsets{16, 8}),
      words(normal<B, 2>({5, 7}, 2), ml::Offsets{3, 2});
  CHECK(same_bits(loaded.embed_motions(motions), model.embed_motions(motions)));
  CHECK(same_bits(loaded.embed_texts(words), model.embed_texts(words)));
  CHECK(loaded.embed_texts(words).size(1) == 9);
}

TEST_CASE("Guo's evaluator: a file that is too small for networks of its sizes is refused before memory is taken") {
  CHECK_ERROR(ml::load_guo_evaluator<B>(models::file_of_shapes({{"movement_encoder.main.0.weight", {2, 1, 1}},
                                                                {"movement_encoder.main.3.weight", {70'000, 1, 1}},
                                                                {"text_encoder.pos_emb.weight", {1, 1}},
                                                                {"text_encoder.hidden", {1, 1, 1}},
                                                                {"motion_encoder.hidden", {1, 1, 1}},
                                                                {"text_encoder.output_net.3.weight", {1, 1}}})),
              "[motionlang.config.102] model.ckpt: 70006 numbers, a network of its sizes has at least");
}

TEST_CASE("Guo's evaluator: other networks are refused by the names of their tensors") {
  ml::Philox rng{.seed = 8};
  const ml::GuoEvaluator<B> model({.features = 9,
                                   .movement_hidden = 4,
                                   .movement_latent = 4,
                                   .word = 4,
                                   .pos = 3,
                                   .text_hidden = 4,
                                   .motion_hidden = 4,
                                   .embedding = 4},
                                  rng);
  CHECK_ERROR(ml::load_guo_evaluator<B>(file_of(model.text_encoder)), "[motionlang.io.406]");
  CHECK_ERROR(ml::load_guo_evaluator<B>(file_of(model, {"movement_dec.main.0.weight"})), "movement_dec.main.0.weight");
}
