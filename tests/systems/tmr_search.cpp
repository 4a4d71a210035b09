// The model of searches that comes with motionlang, loaded by the library alone: texts and motions are in one space,
// and an index of motions is searched by words.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/search/index_folder.hpp>
#include <motionlang/search/search.hpp>
#include <motionlang/search/text_answer.hpp>
#include <motionlang/search/tmr_search_encoder.hpp>
#include <motionlang/weights/actor_checkpoint.hpp>
#include <motionlang/weights/sinc_checkpoint.hpp>
#include <motionlang/weights/teach_checkpoint.hpp>
#include <motionlang/weights/temos_checkpoint.hpp>
#include <motionlang/weights/tm2t_checkpoint.hpp>

#include "../support/check_error.hpp"
#include "../support/small_model.hpp"
#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

TEST_CASE("the bundled TMR finds motions by words, in fifteen lines") {
  const TemporaryFolder folder;
  ml::write_motion(folder / "walk.bvh", synthetic::walk({.frames = 80}));
  ml::write_motion(folder / "jump.bvh", synthetic::jump());

  const ml::TmrSearchEncoder<B> tmr(ml::load_tmr<B>(MOTIONLANG_BUNDLED_TMR));
  ml::MotionIndex index(ml::index_model(tmr));
  const ml::IndexReport report = ml::update_index(index, folder.path, tmr);
  ml::write_motion_index(folder / "moves.index", index);
  const auto file = ml::MotionIndexFile::open(folder / "moves.index");
  const auto hits = ml::search(file, tmr.encode_text("a person walks forward"), {.top = 2});

  CHECK(report.added == 2);
  REQUIRE(hits.size() == 2);
  CHECK(ml::clip_of(file.index(), hits[0]).path.ends_with("walk.bvh"));
  CHECK(hits[0].score > hits[1].score);
}

TEST_CASE("the checkpoint encodes texts and motions, the encoder of an index the same") {
  const auto tmr = ml::load_tmr<B>(MOTIONLANG_BUNDLED_TMR);
  const ml::TmrSearchEncoder<B> encoder(tmr);
  const std::vector<std::string> texts{"a person waves", "a person jumps"};
  const auto latents = tmr.encode_text(texts);
  CHECK(latents.size(0) == 2);
  CHECK(latents.size(1) == encoder.model().width);
  CHECK(latents.to_vector() == encoder.encode_texts(texts));
  CHECK(tmr.fps == encoder.model().fps);
  CHECK(encoder.model().id == tmr.id);
  CHECK(tmr.id.size() == 16);
  CHECK(encoder.model().path == MOTIONLANG_BUNDLED_TMR);
  const ml::Motion walk = synthetic::walk({.frames = 60});
  CHECK(tmr.encode_motion(walk).to_vector() == ml::encode_motion(encoder, walk));
}

TEST_CASE("captions that the bundled models learned from tell what a query means") {
  const ml::TmrSearchEncoder<B> tmr(ml::load_tmr<B>(MOTIONLANG_BUNDLED_TMR));
  const auto seat = tmr.meant("please sit down on the chair");
  REQUIRE_FALSE(seat.empty());
  CHECK(seat[0] == "sit down on a chair");
  CHECK(tmr.meant("jumpp") == tmr.meant("jump"));
  CHECK(tmr.meant("flibber glorp").empty());
  CHECK_FALSE(tmr.known_words().knows("glorp"));
  ml::MotionIndex index(ml::index_model(tmr));
  const TemporaryFolder folder;
  ml::write_motion(folder / "walk.bvh", synthetic::walk({.frames = 80}));
  ml::update_index(index, folder.path, tmr);
  const ml::MotionSearch moves(index);
  CHECK(ml::answer_text(moves, tmr, "somebody is going for a walk").shown);
  CHECK(ml::answer_text(moves, tmr, "wlaks").shown);
  CHECK(ml::answer_text(moves, tmr, "give a handshake").unheard.empty());
  CHECK_FALSE(ml::answer_text(moves, tmr, "the stock market fell again").shown);
}

TEST_CASE("a model whose known captions are missing is refused") {
  const TemporaryFolder folder;
  std::filesystem::copy(MOTIONLANG_BUNDLED_TMR, folder / "tmr");
  CHECK_ERROR(ml::load_tmr<B>(folder / "tmr"), "text.known_captions names");
  std::filesystem::copy(MOTIONLANG_BUNDLED_TMR "/weights.safetensors", folder / "stmc_free.safetensors");
  CHECK_ERROR(ml::load_tmr<B>(folder / "tmr"), "[motionlang.config.103]");
  const auto config = small::config();
  ml::save_stmc(folder / "stmc_free.safetensors", ml::make_stmc<B>(config, small::tokenizer(), ml::Philox{.seed = 1}),
                config, {});
  CHECK_ERROR(ml::load_tmr<B>(folder / "tmr"), "lists no captions");
}

TEST_CASE("a folder of another system is refused by name") {
  CHECK_ERROR(ml::load_temos<B>(MOTIONLANG_BUNDLED_TMR), "[motionlang.config.102]");
  CHECK_ERROR(ml::load_sinc<B>(MOTIONLANG_BUNDLED_TMR), "[motionlang.config.");
  CHECK_ERROR(ml::load_teach<B>(MOTIONLANG_BUNDLED_TMR), "[motionlang.config.");
  CHECK_ERROR(ml::load_actor<B>(MOTIONLANG_BUNDLED_TMR), "[motionlang.config.102]");
  CHECK_ERROR(ml::load_tm2t<B>(MOTIONLANG_BUNDLED_TMR), "[motionlang.io.404]");
  CHECK_ERROR(ml::load_tmr<B>("/nowhere"), "[motionlang.io.401]");
}
