// load_stmc, load_actor, load_temos, load_teach, load_sinc and load_tm2t of one path: the folders of published models
// give what the readers of these folders give, and load_stmc reads files of ours as well.
#include <motionlang/generate/generate_motion.ipp>
#include <motionlang/weights/actor_checkpoint.hpp>
#include <motionlang/weights/checkpoint_options.hpp>
#include <motionlang/weights/sinc_checkpoint.hpp>
#include <motionlang/weights/stmc_checkpoint.hpp>
#include <motionlang/weights/teach_checkpoint.hpp>
#include <motionlang/weights/temos_checkpoint.hpp>
#include <motionlang/weights/text_motion_checkpoint.hpp>
#include <motionlang/weights/tm2t_checkpoint.hpp>

#include "../support/check_error.hpp"
#include "../support/official_folders.hpp"
#include "../support/official_tm2t.hpp"
#include "../support/official_vaes.hpp"
#include "../support/small_model.hpp"
#include "../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;
using ml::Index;
using official::all_numbers;
using official::B;

TEST_CASE("load_stmc: the folders of a published STMC, MDM and MotionDiffuse") {
  const official::Sizes sizes = official::small();
  const TemporaryFolder clip;
  official::write_clip(clip.path, sizes);
  const auto timeline = small::several_tracks();
  const auto check = [&](const std::string& system, const auto& write) {
    INFO(system);
    const TemporaryFolder folder;
    write(folder.path, sizes);
    const auto stmc = ml::load_stmc<B>(folder.path, {.text_encoder = clip.path});
    CHECK_FALSE(stmc.text_encoder.captions);
    const auto wanted = official::expected(system, sizes);
    CHECK(small::numbers(stmc.generate(timeline, ml::Philox{.seed = 5})) ==
          small::numbers(wanted.generate(timeline, ml::Philox{.seed = 5})));
    CHECK_ERROR(ml::load_stmc<B>(folder.path, {.text_encoder = "/nowhere"}), "[motionlang.io.401]");
  };
  check("stmc", [](const fs::path& f, const official::Sizes& s) { official::write_stmc_run(f, s); });
  check("mdm", [](const fs::path& f, const official::Sizes& s) { official::write_mdm_run(f, s); });
  check("motiondiffuse", [](const fs::path& f, const official::Sizes& s) { official::write_motiondiffuse_run(f, s); });
}

TEST_CASE("load_stmc: a file of ours, a folder with it, and a training with that inside give the same motion") {
  const TemporaryFolder folder;
  const fs::path file = folder / "run/model.safetensors";
  fs::create_directories(file.parent_path());
  ml::save_stmc(file, small::model<B>(), small::config(), {}, ml::DType::F32);
  const auto alone = ml::load_stmc<B>(file);
  const auto timeline = small::several_tracks();
  const auto want = ml::generate_motion(alone, timeline, {.seed = 3});
  for (const fs::path& path : {file, file.parent_path()}) {
    const auto stmc = ml::load_stmc<B>(path, {});
    REQUIRE(stmc.text_encoder.captions);
    CHECK(stmc.guidance == alone.guidance);
    CHECK(stmc.steps == alone.steps);
    CHECK(stmc.fps == alone.fps);
    CHECK(all_numbers(stmc) == all_numbers(alone));
    CHECK(ml::generate_motion(stmc, timeline, {.seed = 3}).root == want.root);
  }
  CHECK_ERROR(ml::load_stmc<B>(file, {.text_encoder = "clip"}), "this one has its own");
  CHECK_ERROR(ml::load_stmc<B>(file, {.statistics = "meta"}), "this one has its own");
  CHECK_ERROR(ml::load_stmc<B>("/nowhere", {}), "[motionlang.io.401]");
  CHECK_ERROR(ml::load_stmc<B>(folder.path, {}), "0 .safetensors files where one is expected");

  official::write_actor_run(folder / "actor", official::small_actor());
  CHECK_ERROR(ml::load_stmc<B>(folder / "actor", {}), "of actor; diffusion models are those of stmc");
}

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
