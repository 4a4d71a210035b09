// The checkpoint of Guo's evaluator: sizes from shapes, what is skipped, what is refused.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/guo_evaluator_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/file_of_model.hpp"
#include "../../support/temporary_folder.hpp"
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

TEST_CASE("Guo's evaluator: what is written in the published form is read again, with its fingerprint") {
  const TemporaryFolder folder;
  ml::Philox rng{.seed = 8};
  ml::GuoEvaluator<B> model({.features = 9,
                             .movement_hidden = 4,
                             .movement_latent = 5,
                             .word = 6,
                             .pos = 3,
                             .text_hidden = 4,
                             .motion_hidden = 5,
                             .embedding = 7},
                            rng);
  std::filesystem::create_directories(folder / "text_mot_match/model");
  const auto place = folder / "text_mot_match/model/finest.tar";
  ml::write_guo_evaluator(place, model, 12);
  for (const auto& given : {place, folder / "text_mot_match", folder / "text_mot_match/model"}) {
    CHECK(ml::guo_evaluator_path(given) == place);
    CHECK(ml::is_guo_evaluator(given));
  }
  const auto file = ml::open_weights(place, {.path = ""});
  for (const char* name : {"text_encoder.hidden", "text_encoder.gru.weight_ih_l0_reverse",
                           "motion_encoder.output_net.3.bias", "movement_encoder.main.3.weight"})
    CHECK_MESSAGE(file.find(name) != nullptr, name);
  CHECK(ml::to_string(*file.value("epoch")) == "12");
  const auto loaded = ml::load_guo_evaluator<B>(file);
  const ml::Sequences<B> motions(normal<B, 2>({24, 9}, 1), ml::Offsets{16, 8});
  CHECK(same_bits(loaded.embed_motions(motions), model.embed_motions(motions)));
  const std::string before = ml::guo_fingerprint(place);
  CHECK(before.size() == 16);
  model.text_encoder.pos_emb.bias = model.text_encoder.pos_emb.bias + 1;
  ml::write_guo_evaluator(place, model, 12);
  CHECK(ml::guo_fingerprint(place) != before);
  CHECK(!ml::is_guo_evaluator(folder.path));
  CHECK_ERROR(ml::guo_evaluator_path(folder.path), "no finest.tar and no model/finest.tar");
}

TEST_CASE("the movement autoencoder: written as published and read, with the sizes of its tensors") {
  const TemporaryFolder folder;
  ml::Philox rng{.seed = 9};
  const ml::MovementAutoencoder<B> model(11, 6, 5, rng);
  std::filesystem::create_directories(folder / "model");
  ml::write_movement_autoencoder(folder / "model/latest.tar", model, 3, 40);
  const auto loaded = ml::load_movement_autoencoder<B>(folder.path);
  const ml::Sequences<B> x(normal<B, 2>({16, 11}, 1), ml::Offsets{8, 8});
  CHECK(same_bits(loaded(x).reconstruction.rows, model(x).reconstruction.rows));
  CHECK(ml::to_string(*ml::open_weights(folder / "model/latest.tar", {.path = ""}).value("total_it")) == "40");
  CHECK_ERROR(ml::load_movement_autoencoder<B>(folder / "none"), "[motionlang.io.401]");
}
