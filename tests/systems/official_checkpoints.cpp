// load_actor, load_temos, load_teach, load_sinc and load_tm2t of one path: the folders of published models give what
// the readers of these folders give.
#include <motionlang/weights/actor_checkpoint.hpp>
#include <motionlang/weights/sinc_checkpoint.hpp>
#include <motionlang/weights/teach_checkpoint.hpp>
#include <motionlang/weights/temos_checkpoint.hpp>
#include <motionlang/weights/text_motion_checkpoint.hpp>
#include <motionlang/weights/tm2t_checkpoint.hpp>

#include "../support/check_error.hpp"
#include "../support/official_tm2t.hpp"
#include "../support/official_vaes.hpp"
#include "../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;
using ml::Index;
using official::all_numbers;
using official::B;

TEST_CASE("load_actor: a published folder") {
  const TemporaryFolder folder;
  const auto config = official::small_actor();
  official::write_actor_run(folder.path, config);
  const auto actor = ml::load_actor<B>(folder.path);
  CHECK(all_numbers(actor.actor) == all_numbers(official::actor(config)));
  CHECK(actor.file.labels.size() == 12);
  CHECK_ERROR(ml::load_temos<B>(folder.path), "of actor, expected temos");
  CHECK_ERROR(ml::load_tm2t<B>(folder.path), "[motionlang.io.404]");
}

TEST_CASE("load_teach and load_sinc: published folders, their texts and their features") {
  const TemporaryFolder folder;
  official::write_temos_statistics(folder / "stats", 135);
  official::write_text(folder / "words/vocab.txt", official::bert_vocabulary);
  const ml::CheckpointOptions options{.text_encoder = folder / "words", .statistics = folder / "stats"};
  const auto teach = official::small_teach();
  official::write_lightning_run(folder / "teach", official::teach(teach), teach, 30);
  const auto sinc = official::small_sinc();
  official::write_lightning_run(folder / "sinc", official::sinc(sinc), sinc, 30);

  const auto t = ml::load_teach<B>(folder / "teach", options);
  CHECK(all_numbers(t.model) == all_numbers(official::teach(teach)));
  CHECK(t.fps == 30);
  CHECK(t.features->name == "smplvelp-published");
  CHECK(t.folder == (folder / "teach").string());
  const auto s = ml::load_sinc<B>(folder / "sinc", options);
  CHECK(all_numbers(s.model) == all_numbers(official::sinc(sinc)));
  CHECK(s.normalizer.eps == ml::sinc_eps);
  const std::vector<std::string> texts{"walk", "a walk"};
  const auto run = ml::load_sinc_run<B>(ml::find_run(folder / "sinc"), {options.text_encoder, options.statistics});
  CHECK(s.tokens(texts).rows.to_vector() ==
        run.text_encoder.encode<B>(std::span<const std::string>(texts)).tokens.rows.to_vector());
  CHECK(s.encode_text(texts).size(0) == 2);
  CHECK(s.encode_text("walk").size(1) == sinc.latent_dim);

  CHECK_ERROR(ml::load_temos<B>(folder / "teach", options), "a checkpoint of teach, expected temos");
  CHECK_ERROR(ml::load_teach<B>(folder / "sinc", options), "a checkpoint of sinc, expected teach");
  CHECK_ERROR(ml::load_sinc<B>(folder / "teach", options), "a checkpoint of teach, expected sinc");
  CHECK_ERROR(ml::load_sinc<B>(folder / "sinc"), "[motionlang.io.401]");
}

TEST_CASE("load_temos: a published folder") {
  const TemporaryFolder folder;
  const auto config = official::small_temos();
  official::write_temos_run(folder / "run", config);
  official::write_temos_statistics(folder / "stats", config.nfeats);
  official::write_text(folder / "words/vocab.txt", official::bert_vocabulary);
  const auto temos =
      ml::load_temos<B>(folder / "run", {.text_encoder = folder / "words", .statistics = folder / "stats"});
  CHECK(all_numbers(temos.model) == all_numbers(official::temos(config)));
  CHECK(temos.fps == 12.5);
  CHECK(temos.text_encoder == (folder / "words").string());
}

TEST_CASE("load_tm2t: the folder tells which of the two models it is of") {
  const TemporaryFolder folder;
  const auto config = official::small_tm2t();
  const fs::path t2m = official::write_tm2t_runs(folder.path, config), m2t = t2m.parent_path() / "M2T_EL2_DL1_NH2_PS";
  const auto generator = ml::load_tm2t<B>(t2m), describer = ml::load_tm2t<B>(m2t);
  CHECK(all_numbers(generator.model.t2m_model) == all_numbers(ml::load_tm2t_run<B>(ml::find_run(t2m)).model.t2m_model));
  CHECK(all_numbers(describer.model.m2t_transformer) ==
        all_numbers(ml::load_tm2t_describer<B>(ml::find_run(m2t)).model.m2t_transformer));
}
