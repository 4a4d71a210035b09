// Official run folders of ACTOR and TEMOS: what they load as, what generation makes of it, the errors when something
// is missing.
#include <motionlang/weights/vae_run.hpp>

#include "../support/check_error.hpp"
#include "../support/official_vaes.hpp"
#include "../support/small_model.hpp"
#include "../support/temporary_folder.hpp"
#include "../support/tests_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;
using ml::Index;
using official::all_numbers;
using official::B;

TEST_CASE("ACTOR: opt.yaml and the last checkpoint") {
  const TemporaryFolder folder;
  const auto config = official::small_actor();
  official::write_actor_run(folder.path, config);
  const auto run = ml::load_actor_run<B>(folder.path);
  CHECK(run.model.config == config);
  CHECK(all_numbers(run.model) == all_numbers(official::actor(config)));
  CHECK(run.labels.size() == 12);
  CHECK((run.features && run.features->translation && run.features->global && run.camera));
  const std::vector<Index> action{3}, duration{10};
  ml::Philox rng{.seed = 1}, same{.seed = 1};
  const auto a = ml::generate(run.model, action, duration, rng),
             b = ml::generate(official::actor(config), action, duration, same);
  CHECK(a.rows.shape() == ml::Shape{10, 150});
  CHECK(small::is_finite(a.rows));
  for (std::size_t i = 0; i < a.rows.span().size(); ++i)
    CHECK(a.rows.span()[i] == doctest::Approx(b.rows.span()[i]).epsilon(1e-4));
}

TEST_CASE("ACTOR: the run folder of the golden files") {
  const fs::path golden = fs::path(tests_folder()) / "golden/cases/containers/actor_run";
  CHECK_THROWS_AS(ml::load_actor_run<B>(golden), ml::error);  // a few tensors only
  CHECK(ml::find_run(golden).system == "actor");
  CHECK(ml::find_run(golden).weights.filename() == "checkpoint_0100.pth.tar");
}

TEST_CASE("ACTOR: options that contradict the tensors, variants that are not read") {
  const TemporaryFolder folder;
  official::write_actor_run(folder.path, official::small_actor());
  const std::string options = ml::read_file(folder / "opt.yaml");
  const auto refused = [&](const std::string& from, const std::string& to, const char* message) {
    std::string changed = options;
    REQUIRE(changed.find(from) != std::string::npos);
    changed.replace(changed.find(from), from.size(), to);
    official::write_text(folder / "opt.yaml", changed);
    CHECK_ERROR(ml::load_actor_run<B>(folder.path), message);
  };
  refused("latent_dim: 16", "latent_dim: 32", "latent_dim is 32, tensor 'encoder.muQuery'");
  refused("archiname: transformer", "archiname: gru", "archiname is 'gru', the tensors are those of transformer");
  refused("translation: true", "translation: false", "glob and translation make 24 rows a frame");
  refused("pose_rep: rot6d", "pose_rep: xyz", "positions are supported for the 24 of SMPL");
  refused("pose_rep: rot6d", "pose_rep: rotquat", "joints of 4 numbers, frames have 150");
  official::write_text(folder / "opt.yaml", options);
  official::write_actor_run(folder.path, official::small_actor(), "extra.weight");
  CHECK_ERROR(ml::load_actor_run<B>(folder.path), "unexpected extra.weight");
  CHECK_ERROR(ml::load_temos_run<B>(folder.path), "of actor, expected temos");
  fs::remove(folder / "checkpoint_5000.pth.tar");
  fs::remove(folder / "checkpoint_0900.pth.tar");
  CHECK_ERROR(ml::load_actor_run<B>(folder.path), "[motionlang.io.401]");
}

TEST_CASE(
    "TEMOS: .hydra/config.yaml, checkpoints/last.ckpt with DistilBERT inside, statistics and tokenizer from "
    "elsewhere") {
  const TemporaryFolder folder;
  const auto run = folder / "run";
  const auto config = official::small_temos();
  official::write_temos_run(run, config);
  CHECK_ERROR(ml::load_temos_run<B>(run), "put jfeats_mean.pt and jfeats_std.pt");
  official::write_temos_statistics(folder / "stats", config.nfeats);
  CHECK_ERROR(ml::load_temos_run<B>(run, {.statistics = folder / "stats"}),
              "no tokenizer of DistilBERT: put vocab.txt");
  official::write_text(folder / "words/vocab.txt", official::bert_vocabulary);
  const auto loaded = ml::load_temos_run<B>(run, {.text_encoder = folder / "words", .statistics = folder / "stats"});
  CHECK(loaded.fps == 12.5);
  CHECK(loaded.width() == config.nfeats);
  fs::rename(folder / "words", folder / "distilbert-base-uncased");  // found beside the model, however this is named
  for (const char* name : {"", "/", "/.", "/checkpoints/.."})
    CHECK_NOTHROW(ml::load_temos_run<B>(fs::path(run.string() + name), {.statistics = folder / "stats"}));
  fs::rename(folder / "distilbert-base-uncased", folder / "words");
  CHECK(small::numbers(loaded.normalizer.std) == small::numbers(official::statistics(config.nfeats, 6).std));
  CHECK(all_numbers(loaded.model) == all_numbers(official::temos(config)));
  const std::vector<std::string> texts{"walk", "a walk"};
  const auto tokens = loaded.text_encoder.encode<B>(std::span<const std::string>(texts)).tokens;
  CHECK((tokens.offsets.length(0) == 3 && tokens.offsets.length(1) == 4 && tokens.width() == config.text_dim));
  const auto motions = ml::text_to_motion(loaded.model, tokens, ml::Offsets{8, 9}, ml::Philox{});
  CHECK(motions.front().rows.shape() == ml::Shape{17, config.nfeats});
  CHECK(small::is_finite(motions.front().rows));
  official::write_text(run / ".hydra/config.yaml", "model:\n  latent_dim: 17\n");
  CHECK_ERROR(ml::load_temos_run<B>(run, {.text_encoder = folder / "words", .statistics = folder / "stats"}),
              "model/latent_dim is 17, tensor 'textencoder.projection.1.weight'");
}

TEST_CASE("TEACH and SINC: the same folder, other tensors") {
  const TemporaryFolder folder;
  official::write_temos_statistics(folder / "stats", 135);
  official::write_text(folder / "words/vocab.txt", official::bert_vocabulary);
  const ml::TemosRunOptions options{.text_encoder = folder / "words", .statistics = folder / "stats"};
  const auto teach = official::small_teach();
  official::write_lightning_run(folder / "teach", official::teach(teach), teach, 30);
  const auto loaded = ml::load_teach_run<B>(ml::find_run(folder / "teach"), options);
  CHECK(loaded.model.config == teach);
  CHECK(all_numbers(loaded.model) == all_numbers(official::teach(teach)));
  CHECK((loaded.fps == 30 && loaded.width() == 135 && loaded.normalizer.eps == 0));

  const auto sinc = official::small_sinc();
  official::write_lightning_run(folder / "sinc", official::sinc(sinc), sinc, 30);
  const auto other = ml::load_sinc_run<B>(ml::find_run(folder / "sinc"), options);
  CHECK(all_numbers(other.model) == all_numbers(official::sinc(sinc)));
  CHECK(other.normalizer.eps == ml::sinc_eps);

  CHECK_ERROR(ml::load_temos_run<B>(folder / "teach", options), "a checkpoint of teach, expected temos");
  CHECK_ERROR(ml::load_teach_run<B>(ml::find_run(folder / "sinc"), options), "a checkpoint of sinc, expected teach");
  CHECK_ERROR(ml::load_sinc_run<B>(ml::find_run(folder / "teach"), options), "a checkpoint of teach, expected sinc");
}
