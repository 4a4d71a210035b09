// The motionlang program on folders as the official repositories leave them: generate, convert --denoise.
#include <doctest/doctest.h>

#include <set>

#include <algorithm>

#include <motionlang/c/motionlang_c.h>
#include <motionlang/core/numpy_random.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/root_motion.hpp>
#include <motionlang/metrics/ape_ave.hpp>
#include <motionlang/metrics/guo_evaluator.hpp>
#include <motionlang/metrics/matching.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/metrics/temos_score.hpp>
#include <motionlang/weights/embedding_cache.hpp>

#include "../support/denoised.hpp"
#include "../support/official_tm2t.hpp"
#include "../support/official_vaes.hpp"
#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"
#include "official_workplace.hpp"

namespace fs = std::filesystem;

namespace {

/// A model that the C functions have loaded.
class LoadedByC {
 public:
  LoadedByC(const fs::path& folder, const char* text_encoder = nullptr, const char* statistics = nullptr) {
    const int status = motionlang_load_model_with(folder.string().c_str(), text_encoder, statistics, &model_);
    REQUIRE_MESSAGE(status == 0, motionlang_message());
  }
  LoadedByC(const LoadedByC&) = delete;
  LoadedByC& operator=(const LoadedByC&) = delete;
  ~LoadedByC() { motionlang_free_model(model_); }

  bool takes_actions() const { return motionlang_model_takes_actions(model_) == 1; }
  double fps() const { return motionlang_model_fps(model_); }
  /// The BVH file of its motion; the message of an error.
  std::string bvh(const char* timeline, const fs::path& file) const {
    motionlang_motion* motion = nullptr;
    if (motionlang_generate(model_, timeline, nullptr, &motion) != 0) return motionlang_message();
    CHECK(motionlang_write_motion(motion, file.string().c_str()) == 0);
    motionlang_free_motion(motion);
    return ml::read_file(file);
  }

 private:
  motionlang_model* model_ = nullptr;
};

}  // namespace

TEST_CASE("generate: folders of STMC, MDM and MotionDiffuse, from a text and from a timeline") {
  const OfficialWorkplace w;
  const auto sizes = official::small();
  official::write_stmc_run(w / "stmc", sizes);
  official::write_mdm_run(w / "mdm", sizes);
  official::write_motiondiffuse_run(w / "motiondiffuse", sizes);
  const Outcome missing = w.run({"generate", "--model", "mdm", "--text", "walk"});
  CHECK(missing.code == 1);
  CHECK(contains(missing.text, "ViT-B-32.pt with bpe_simple_vocab_16e6.txt.gz"));
  official::write_clip(w / "clip", sizes);
  for (const std::string model : {"stmc", "mdm", "motiondiffuse"}) {
    CAPTURE(model);
    w.did({"generate", "--model", model, "--text", "A walk, slowly!", "--seconds", "1.5", "--out", model + "_out",
           "--steps", "2"});
    for (const char* end : {".bvh", ".glb", ".npz", ".svg", ".html"})
      CHECK(fs::exists(w / (model + "_out/A_walk_slowly" + end)));
    CHECK(w.joints(model + "_out/A_walk_slowly.npy") == std::vector<ml::Index>{30, 24, 3});
  }
  ml::write_file(w / "two.txt", std::string_view("walk # 0 # 1 # legs\nwave # 0.2 # 0.8 # right arm\n"));
  w.did({"generate", "--model", "mdm", "--timeline", "two.txt", "--steps", "2"});
  CHECK(w.joints("out/two.npy") == std::vector<ml::Index>{20, 24, 3});
  const Outcome longer = w.run({"generate", "--model", "mdm", "--text", "walk", "--seconds", "12", "--no-cut-texts"});
  CHECK(longer.code == 3);
  CHECK(contains(longer.text, "the denoiser accepts 196"));
  CHECK(w.run({"generate", "--model", "mdm", "--text", "walk", "--timeline", "two.txt"}).code == 2);
  CHECK(w.run({"generate", "--model", "mdm"}).code == 2);
}

TEST_CASE("generate: ACTOR takes actions, TEMOS a text") {
  const OfficialWorkplace w;
  official::write_actor_run(w / "actor", official::small_actor());
  w.did({"generate", "--model", "actor", "--action", "walk", "--seconds", "1"});
  CHECK(w.joints("out/walk.npy") == std::vector<ml::Index>{20, 24, 3});
  w.did({"generate", "--model", "actor", "--action", "1", "--seconds", "1"});
  CHECK(ml::read_file(w / "out/walk.bvh") == ml::read_file(w / "out/1.bvh"));
  const Outcome dance = w.run({"generate", "--model", "actor", "--action", "dance"});
  CHECK(dance.code == 1);
  CHECK(contains(dance.text, "action 'dance' is not one of 0 ... 11; they are called warm_up, walk"));
  ml::write_file(w / "two.txt", std::string_view("walk # 0 # 1 # legs\nrun # 0.2 # 0.8 # right arm\n"));
  CHECK(w.run({"generate", "--model", "actor", "--timeline", "two.txt"}).code == 3);
  const LoadedByC actor(w / "actor");
  CHECK(actor.takes_actions());
  CHECK(actor.bvh("walk # 0 # 1\n", w / "c.bvh") == ml::read_file(w / "out/walk.bvh"));
  CHECK(actor.bvh("dance # 0 # 1\n", w / "c.bvh").starts_with("[motionlang.config.103] "));

  official::write_temos_run(w / "temos", official::small_temos());
  official::write_temos_statistics(w / "statistics", 64);
  official::write_text(w / "words/vocab.txt", official::bert_vocabulary);
  w.did({"generate", "--model", "temos", "--text", "a walk", "--seconds", "2", "--statistics", "statistics",
         "--text-encoder", "words"});
  CHECK(w.joints("out/a_walk.npy") == std::vector<ml::Index>{25, 21, 3});
  const LoadedByC temos(w / "temos", (w / "words").string().c_str(), (w / "statistics").string().c_str());
  CHECK(!temos.takes_actions());
  CHECK(temos.fps() == 12.5);
  CHECK(temos.bvh("a walk # 0 # 2\n", w / "c.bvh") == ml::read_file(w / "out/a_walk.bvh"));
}

TEST_CASE("generate: a published ACTOR whose frames are positions (pose_rep xyz)") {
  const OfficialWorkplace w;
  ml::ActorConfig c = official::small_actor();
  c.nfeats = 3, c.njoints = 24;
  official::write_actor_run(w / "actor", c, "", "xyz");
  w.did({"generate", "--model", "actor", "--action", "walk", "--seconds", "1"});
  CHECK(w.joints("out/walk.npy") == std::vector<ml::Index>{20, 24, 3});
  CHECK(contains(w.did({"info", "actor"}), "24 rows of 3 numbers a frame (xyz)"));
  ml::write_bvh(w / "noisy.bvh", synthetic::walk({.frames = 40, .fps = 20}));
  w.did({"convert", "noisy.bvh", "clean.bvh", "--denoise", "actor", "--action", "walk"});
  CHECK(ml::read_bvh_motion(w / "clean.bvh").frames() == 40);
  c.njoints = 18;  // those of NTU-13's own positions
  official::write_actor_run(w / "ntu", c, "", "xyz");
  const Outcome ntu = w.run({"generate", "--model", "ntu", "--action", "walk"});
  CHECK_MESSAGE((ntu.code == 1 && contains(ntu.text, "[motionlang.io.404]") && contains(ntu.text, "has 18 joints")),
                ntu.text);
}

TEST_CASE("generate --towards: ACTOR from action to action, TEMOS and SINC from text to text, others not") {
  const OfficialWorkplace w;
  const auto generate = [&](std::vector<std::string> more) {
    more.insert(more.begin(), "generate");
    more.insert(more.end(), {"--seconds", "1", "--seed", "3", "--no-smooth", "--no-fix-feet", "--no-fix-floor"});
    return w.did(more);
  };
  const auto is_line = [&](const std::string& first, const std::string& last) {
    const std::string line = "out/" + first + "_to_" + last + "_";
    const auto motion = [&](const std::string& file) { return ml::read_bvh_motion(w / file); };
    CHECK(synthetic::largest_distance(motion(line + "1.bvh"), motion("out/" + first + ".bvh")) < 1e-3);
    CHECK(synthetic::largest_distance(motion(line + "3.bvh"), motion("out/" + last + ".bvh")) < 1e-3);
    for (const char* end : {"1.bvh", "3.bvh"})
      CHECK(synthetic::largest_distance(motion(line + "2.bvh"), motion(line + end)) > 1e-3);
    CHECK(fs::exists(w / (line + "3.svg")));
    CHECK(!fs::exists(w / (line + "4.bvh")));
  };
  official::write_actor_run(w / "actor", official::small_actor());
  for (const char* action : {"walk", "run"}) generate({"--model", "actor", "--action", action});
  generate({"--model", "actor", "--action", "walk", "--towards", "run", "--samples", "3"});
  is_line("walk", "run");
  CHECK(contains(ml::read_file(w / "out/walk_to_run.html"), "walk 50 %, run 50 %"));
  generate({"--model", "actor", "--action", "walk", "--towards", "run"});
  CHECK(fs::exists(w / "out/walk_to_run_5.bvh"));
  const auto refused = [&](std::vector<std::string> more, const std::string& message) {
    more.insert(more.begin(), "generate");
    const Outcome out = w.run(more);
    CHECK(out.code == 2);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  const Outcome dance = w.run({"generate", "--model", "actor", "--action", "walk", "--towards", "dance"});
  CHECK_MESSAGE((dance.code == 1 && contains(dance.text, "action 'dance' is not one of 0 ... 11")), dance.text);
  refused({"--model", "actor", "--action", "walk", "--towards", "run", "--samples", "1"},
          "[motionlang.config.101] 1 motion");
  refused({"--model", "actor", "--action", "walk", "--towards", "run", "--noise", "n.safetensors"},
          "--noise is for diffusion models");

  const auto sources = [](const std::string& model) -> std::vector<std::string> {
    return {"--model", model, "--statistics", model == "temos" ? "of64" : "of135", "--text-encoder", "words"};
  };
  official::write_temos_run(w / "temos", official::small_temos());
  const auto sinc = official::small_sinc();
  official::write_lightning_run(w / "sinc", official::sinc(sinc), sinc, 30);
  const auto teach = official::small_teach();
  official::write_lightning_run(w / "teach", official::teach(teach), teach, 30);
  official::write_temos_statistics(w / "of64", 64);
  official::write_temos_statistics(w / "of135", 135);
  official::write_text(w / "words/vocab.txt", official::bert_vocabulary);
  for (const std::string model : {"temos", "sinc"}) {
    CAPTURE(model);
    fs::remove_all(w / "out");
    const auto with = [&](std::vector<std::string> more) {
      const auto from = sources(model);
      more.insert(more.end(), from.begin(), from.end());
      generate(more);
    };
    for (const char* text : {"a walk", "walk"}) with({"--text", text});
    with({"--text", "a walk", "--towards", "walk", "--samples", "3"});
    is_line("a_walk", "walk");
  }
  auto of_teach = sources("teach");
  of_teach.insert(of_teach.end(), {"--text", "walk", "--towards", "a walk"});
  refused(of_teach,
          "[motionlang.config.102] teach: --towards is for models with one latent for every motion (ACTOR, TEMOS, TMR, "
          "SINC); this is TEACH");
  official::write_mdm_action_run(w / "mdm", official::small());
  refused({"--model", "mdm", "--action", "walk", "--towards", "run"}, "this is a diffusion model");
}

TEST_CASE("generate --samples: ACTOR, TEMOS and MDM for actions") {
  const OfficialWorkplace w;
  official::write_actor_run(w / "actor", official::small_actor());
  official::write_mdm_action_run(w / "mdm", official::small());
  for (const std::string model : {"actor", "mdm"}) {
    CAPTURE(model);
    w.did({"generate", "--model", model, "--action", "walk", "--seconds", "1", "--seed", "3", "--samples", "2", "--out",
           model + "_out"});
    w.did({"generate", "--model", model, "--action", "walk", "--seconds", "1", "--seed", "3", "--out", model + "_out"});
    const auto bytes = [&](const std::string& file) { return ml::read_file(w / (model + "_out/" + file)); };
    CHECK(bytes("walk_1.bvh") == bytes("walk.bvh"));
    CHECK(bytes("walk_2.bvh") != bytes("walk.bvh"));
  }
}

TEST_CASE("generate --fact: how far latents are from their mean; refused where there are none") {
  const OfficialWorkplace w;
  const auto sinc = official::small_sinc();
  const auto teach = official::small_teach();
  official::write_actor_run(w / "actor", official::small_actor());
  official::write_temos_run(w / "temos", official::small_temos());
  official::write_lightning_run(w / "sinc", official::sinc(sinc), sinc, 30);
  official::write_lightning_run(w / "teach", official::teach(teach), teach, 30);
  for (const std::string model : {"temos", "sinc", "teach"})
    official::write_text(w / (model + "/vocab.txt"), official::bert_vocabulary);
  official::write_temos_statistics(w / "temos", 64);
  for (const std::string model : {"sinc", "teach"}) official::write_temos_statistics(w / model, 135);
  for (const std::string model : {"actor", "temos", "sinc", "teach"}) {
    CAPTURE(model);
    const auto made = [&](std::vector<std::string> more, const std::string& name = "walk") {
      more.insert(more.begin(),
                  {"generate", "--model", model, model == "actor" ? "--action" : "--text", "walk", "--seconds", "1"});
      w.did(more);
      const std::string bvh = ml::read_file(w / ("out/" + name + ".bvh"));
      fs::remove_all(w / "out");
      return bvh;
    };
    const std::string plain = made({"--seed", "1"}), half = made({"--seed", "1", "--fact", "0.5"}),
                      mean = made({"--seed", "1", "--fact", "0"});
    CHECK(made({"--seed", "1", "--fact", "1"}) == plain);
    CHECK(made({"--seed", "2"}) != plain);
    CHECK(made({"--seed", "2", "--fact", "0"}) == mean);
    CHECK(half != plain);
    CHECK(half != mean);
    if (model == "teach") continue;
    const std::string other = model == "actor" ? "run" : "a walk",
                      line = model == "actor" ? "walk_to_run" : "walk_to_a_walk";
    CHECK(made({"--seed", "1", "--fact", "0.5", "--towards", other}, line + "_1") == half);
  }
  const auto rows = [&](const std::string& fact) {  // of the file that a text makes, against the library
    w.did({"generate", "--model", "temos", "--text", "walk", "--seconds", "1.2", "--fact", fact, "--no-smooth",
           "--no-fix-feet", "--no-fix-floor"});
    return ml::read_bvh_motion(w / "out/walk.bvh");
  };
  const auto run = ml::load_temos_run<official::B>(ml::FilePath(w / "temos"));
  const std::vector<std::string> text{"walk"};
  const auto tokens = run.text_encoder.encode<official::B>(std::span<const std::string>(text)).tokens;
  const auto mean =
      ml::text_to_motion(run.model, tokens, ml::Offsets{15}, ml::Philox{}, 1, {.mean = true}).front().rows;
  const std::vector<double> numbers = [&] {
    const auto x = run.normalizer.denormalize(mean);
    return std::vector<double>(x.span().begin(), x.span().end());
  }();
  const auto expected = ml::motion_of_rows(ml::motion_features("rifke64"), numbers, 12.5);
  CHECK(synthetic::largest_distance(rows("0"), expected) < 1e-2);
  CHECK(synthetic::largest_distance(rows("1"), expected) > 2e-2);

  const auto refused = [&](std::vector<std::string> more, const std::string& message) {
    more.insert(more.begin(), {"generate", "--fact", "0.5", "--out", "refused"});
    const Outcome out = w.run(more);
    CHECK(out.code == 2);
    CHECK_MESSAGE(
        contains(out.text,
                 "--fact is for models that draw a latent (ACTOR, TEMOS, TMR, SINC, TEACH); this is " + message),
        out.text);
    CHECK(!fs::exists(w / "refused/walk.bvh"));
  };
  official::write_mdm_action_run(w / "mdm", official::small());
  refused({"--model", "mdm", "--action", "walk"}, "a diffusion model, which draws none");
  refused({"--model", official::write_tm2t_runs(w.path, official::small_tm2t()).string(), "--text", "walk"},
          "TM2T, which draws none");
  auto exact = official::small_temos();
  exact.vae = false;
  official::write_temos_run(w / "exact", exact);
  refused({"--model", "exact", "--text", "walk", "--statistics", "temos", "--text-encoder", "temos"},
          "a model with one latent");
  CHECK(w.run({"generate", "--model", "actor", "--action", "walk", "--fact", "-1"}).code == 2);
}

TEST_CASE("convert --denoise: encoded and decoded, put where it was; longer motions in parts") {
  const OfficialWorkplace w;
  official::write_actor_run(w / "actor", official::small_actor());
  const auto run = ml::load_actor_run<official::B>(ml::FilePath(w / "actor"));
  auto walk = synthetic::walk({.frames = 150, .turn = 0.3});
  walk = ml::placed(walk, {0.7, {2, 0, -1}});
  const auto cleaned = [&](const ml::Motion& motion) {
    const ml::Index action = 1, frames = motion.frames();
    const auto rows = ml::actor_rows_of_motion(motion, *run.features);
    const std::vector<official::B::scalar> values(rows.begin(), rows.end());
    const ml::Sequences<official::B> x(ml::Tensor<official::B, 2>::from(values, {frames, 150}), ml::Offsets{frames});
    const auto made = ml::denoise(run.model, x, std::span(&action, 1)).rows;
    return ml::motion_of_actor(ml::actor_inverse(made.span(), 24, *run.features), 20);
  };
  const auto differ = [](const ml::Motion& a, const ml::Motion& b) {  // wherever they stand
    return synthetic::largest_distance(ml::placed(a, ml::placement_between(a, 0, b, 0)), b);
  };
  const auto written = [&](const ml::Motion& motion) {  // with its joints in the order of a file
    ml::write_bvh(w / "written.bvh", motion);
    return ml::read_bvh_motion(w / "written.bvh");
  };
  ml::write_bvh(w / "short.bvh", ml::crop(walk, 0, 40));
  w.did({"convert", "short.bvh", "clean.bvh", "--denoise", "actor", "--action", "walk"});
  const auto clean = ml::read_bvh_motion(w / "clean.bvh");
  CHECK(clean.frames() == 40);
  CHECK(differ(clean, written(cleaned(ml::crop(walk, 0, 40)))) < 1e-2);
  CHECK(differ(clean, ml::read_bvh_motion(w / "short.bvh")) > 0.1);
  ml::Vec3<double> away{};
  double turned = 0;
  for (ml::Index f = 0; f < 40; ++f) {
    away = away + clean.root_at(f) - walk.root_at(f);
    turned += std::sin(ml::turn_between(clean.rotations(f)[0], walk.rotations(f)[0]));
  }
  CHECK(std::abs(away.x) < 1e-2);
  CHECK(std::abs(away.z) < 1e-2);
  CHECK(std::abs(turned) < 1e-2);

  // 60 frames at a time, of which 15 are shared
  ml::write_bvh(w / "long.bvh", walk);
  w.did({"convert", "long.bvh", "whole.bvh", "--denoise", "actor", "--action", "1"});
  const auto whole = ml::read_bvh_motion(w / "whole.bvh");
  CHECK(whole.frames() == 150);
  const auto first_part = written(ml::crop(cleaned(ml::crop(walk, 0, 60)), 0, 45));
  CHECK(differ(ml::crop(whole, 0, 45), first_part) < 1e-2);

  // other runs: as many frames at a time as they learned from, all at once where these were any
  const std::string options = ml::read_file(w / "actor/opt.yaml"), frames_of_run = "num_frames: 60\n";
  const auto begins_as_part_of = [&](ml::Index part, const std::string& learned_from) {
    std::string other = options;
    ml::write_file(w / "actor/opt.yaml", other.replace(other.find(frames_of_run), frames_of_run.size(), learned_from));
    w.did({"convert", "long.bvh", "other.bvh", "--denoise", "actor", "--action", "walk"});
    const auto made = ml::read_bvh_motion(w / "other.bvh");
    CHECK(made.frames() == 150);
    const ml::Index alone = part == 150 ? 150 : std::min(part - part / 4, 150 - part);  // before the last part
    const auto expected = written(ml::crop(cleaned(ml::crop(walk, 0, part)), 0, alone));
    CHECK_MESSAGE(differ(ml::crop(made, 0, alone), expected) < 1e-2, learned_from);
    CHECK_MESSAGE(differ(ml::crop(made, 0, 45), first_part) > 2e-2, learned_from);
  };
  begins_as_part_of(80, "num_frames: 80\n");
  begins_as_part_of(100, "num_frames: -2\nmin_len: 60\nmax_len: 100\n");
  begins_as_part_of(120, "num_frames: -1\nmax_len: 120\n");
  begins_as_part_of(150, "num_frames: -1\nmax_len: -1\n");
  ml::write_file(w / "actor/opt.yaml", options);

  // at the rate of the motion, whatever the model's
  w.did({"convert", "short.bvh", "fast.bvh", "--fps", "40"});
  w.did({"convert", "fast.bvh", "slow.bvh", "--denoise", "actor", "--action", "walk"});
  CHECK(ml::read_bvh_motion(w / "slow.bvh").fps == doctest::Approx(40));
  CHECK(synthetic::largest_distance(ml::resample(ml::read_bvh_motion(w / "slow.bvh"), 20), clean) < 1e-2);

  official::write_temos_run(w / "temos", official::small_temos());
  official::write_temos_statistics(w / "statistics", 64);
  official::write_text(w / "words/vocab.txt", official::bert_vocabulary);
  const std::vector<std::string> temos{"convert",      "short.bvh",  "out.bvh",        "--denoise", "temos",
                                       "--statistics", "statistics", "--text-encoder", "words"};
  w.did(temos);
  const auto by_temos = ml::read_bvh_motion(w / "out.bvh");
  CHECK((by_temos.frames() >= 38 && by_temos.frames() <= 40));
  CHECK(by_temos.skeleton.size() == 21);

  const auto sinc = official::small_sinc();
  official::write_lightning_run(w / "sinc", official::sinc(sinc), sinc, 30);
  official::write_temos_statistics(w / "of135", 135);
  w.did(
      {"convert", "short.bvh", "by_sinc.bvh", "--denoise", "sinc", "--statistics", "of135", "--text-encoder", "words"});
  const auto by_sinc = ml::read_bvh_motion(w / "by_sinc.bvh");
  CHECK(by_sinc.fps == doctest::Approx(20));
  CHECK(by_sinc.skeleton.size() == 24);
  const auto sinc_run = ml::load_sinc_run<official::B>(ml::find_run(w / "sinc"),
                                                       {.text_encoder = w / "words", .statistics = w / "of135"});
  const auto expected = models::denoised(sinc_run.model, sinc_run.normalizer, ml::motion_features("smplvelp-published"),
                                         ml::crop(walk, 0, 40), 30);
  CHECK(differ(by_sinc, written(ml::resample(expected, 20))) < 1e-2);
  fs::remove(w / "out.bvh");

  const auto refused = [&](std::vector<std::string> more, const std::string& message) {
    const Outcome out = w.run(more);
    CHECK(out.code == 2);
    CHECK_MESSAGE(contains(out.text, message), out.text);
    CHECK(!fs::exists(w / "out.bvh"));
  };
  refused({"convert", "short.bvh", "out.bvh", "--denoise", "actor"},
          "[motionlang.config.102] ACTOR needs to know which action the motion shows");
  const Outcome dance = w.run({"convert", "short.bvh", "out.bvh", "--denoise", "actor", "--action", "dance"});
  CHECK_MESSAGE((dance.code == 1 && contains(dance.text, "action 'dance' is not one of 0 ... 11")), dance.text);
  auto with_action = temos;
  with_action.insert(with_action.end(), {"--action", "walk"});
  refused(with_action, "[motionlang.config.102] --action 'walk' is for ACTOR");
  official::write_mdm_action_run(w / "mdm", official::small());
  refused({"convert", "short.bvh", "out.bvh", "--denoise", "mdm"},
          "[motionlang.config.102] mdm: --denoise is for models with one latent");
}

TEST_CASE("generate: TEACH takes texts one after the other, SINC texts at the same time") {
  const OfficialWorkplace w;
  const auto teach = official::small_teach();
  const auto sinc = official::small_sinc();
  official::write_lightning_run(w / "teach", official::teach(teach), teach, 30);
  official::write_lightning_run(w / "sinc", official::sinc(sinc), sinc, 30);
  official::write_temos_statistics(w / "statistics", 135);
  official::write_text(w / "distilbert-base-uncased/vocab.txt", official::bert_vocabulary);
  ml::write_file(w / "after.txt", std::string_view("a walk # 0 # 1 # legs # spine\nwalk # 1 # 2.5 # legs\n"));
  ml::write_file(w / "together.txt", std::string_view("a walk # 0 # 1 # legs\nwalk # 0 # 1 # right arm\n"));
  const auto generate = [&](const std::string& model, const std::string& timeline) {
    return w.run({"generate", "--model", model, "--timeline", timeline, "--statistics", "statistics"});
  };
  CHECK(generate("teach", "after.txt").code == 0);
  CHECK(w.joints("out/after.npy") == std::vector<ml::Index>{75, 24, 3});
  const Outcome overlapping = generate("teach", "together.txt");
  CHECK(overlapping.code == 3);
  CHECK(contains(overlapping.text, "'a walk' and 'walk' overlap; this model (TEACH) takes texts one after the other"));
  CHECK(generate("sinc", "together.txt").code == 0);
  CHECK(w.joints("out/together.npy") == std::vector<ml::Index>{30, 24, 3});
  // other sentences, with and without the -ing form
  std::set<std::string> made{ml::read_file(w / "out/together.npy")};
  ml::write_file(w / "tags.txt", std::string_view("a walk while walk#a/DET walk/VERB while/SCONJ walk/VERB#0.0#0.0\n"));
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--tags", "tags.txt"}}) {
    std::vector<std::string> joined{"generate",     "--model",    "sinc",          "--timeline", "together.txt",
                                    "--statistics", "statistics", "--conjunction", "while"};
    joined.insert(joined.end(), more.begin(), more.end());
    const Outcome done = w.run(joined);
    REQUIRE_MESSAGE(done.code == 0, done.text);
    made.insert(ml::read_file(w / "out/together.npy"));
  }
  CHECK(made.size() == 3);
  const Outcome of_teach = w.run({"generate", "--model", "teach", "--timeline", "after.txt", "--statistics",
                                  "statistics", "--conjunction", "while"});
  CHECK(of_teach.code == 2);
  CHECK_MESSAGE(contains(of_teach.text, "teach: --conjunction joins the texts of SINC"), of_teach.text);
}

TEST_CASE("generate: MDM for actions, and TM2T, which decides itself how long a motion is") {
  const OfficialWorkplace w;
  official::write_mdm_action_run(w / "mdm", official::small());
  w.did({"generate", "--model", "mdm", "--action", "walk", "--seconds", "2", "--steps", "3"});
  CHECK(w.joints("out/walk.npy") == std::vector<ml::Index>{40, 24, 3});
  w.did({"generate", "--model", "mdm", "--action", "1", "--seconds", "2", "--steps", "3"});
  CHECK(ml::read_file(w / "out/walk.bvh") == ml::read_file(w / "out/1.bvh"));
  const Outcome longer = w.run({"generate", "--model", "mdm", "--action", "walk", "--seconds", "4"});
  CHECK(longer.code == 3);
  CHECK(contains(longer.text, "'walk' has 80 frames, the model makes 60"));
  CHECK(contains(w.run({"generate", "--model", "mdm", "--action", "walk", "--backend", "reference"}).text,
                 "generated with backend 'eigen'"));

  const auto none = ml::MdmCondition::none;
  official::write_mdm_action_run(w / "free", official::small(), 0.1, none, R"(, "unconstrained": true)");
  w.did({"generate", "--model", "free", "--action", "any", "--seconds", "2", "--steps", "3"});
  CHECK(w.joints("out/any.npy") == std::vector<ml::Index>{40, 24, 3});
  CHECK(contains(w.did({"info", "free"}), "actions                  any"));
  CHECK(contains(w.run({"generate", "--model", "free", "--action", "walk"}).text,
                 "action 'walk' is not one of 0 ... 0; they are called any"));
  official::write_mdm_action_run(w / "wrong", official::small(), 0.1, ml::MdmCondition::action,
                                 R"(, "cond_mode": "no_cond")");
  CHECK(contains(w.run({"generate", "--model", "wrong", "--action", "any"}).text, "[motionlang.io.404]"));

  const fs::path run = official::write_tm2t_runs(w.path, official::small_tm2t());
  w.did({"generate", "--model", run.string(), "--text", "a person walks"});
  const auto shape = w.joints("out/a_person_walks.npy");
  CHECK((shape.size() == 3 && shape[0] > 0 && shape[0] % 4 == 0));
  const std::string first = ml::read_file(w / "out/a_person_walks.bvh");
  w.did({"generate", "--model", run.string(), "--text", "a person walks", "--seed", "1"});
  CHECK(ml::read_file(w / "out/a_person_walks.bvh") != first);
  fs::rename(w / "glove", w / "words");
  CHECK(contains(w.run({"generate", "--model", run.string(), "--text", "walk"}).text, "no word vectors"));
  w.did({"generate", "--model", run.string(), "--text", "a person walks", "--text-encoder", "words", "--out", "again"});
  CHECK(ml::read_file(w / "again/a_person_walks.bvh") == first);
}
