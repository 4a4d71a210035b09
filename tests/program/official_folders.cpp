// The motionlang program on folders as the official repositories leave them: pack, info, describe, embed.
#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include <nlohmann/json.hpp>

#include <motionlang/core/numpy_random.hpp>
#include <motionlang/features/joint_sets.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/metrics/ape_ave.hpp>
#include <motionlang/metrics/guo_evaluator.hpp>
#include <motionlang/metrics/matching.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/metrics/temos_score.hpp>
#include <motionlang/weights/embedding_cache.hpp>

#include "../support/official_tm2t.hpp"
#include "../support/official_vaes.hpp"
#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"
#include "../support/tests_folder.hpp"
#include "official_workplace.hpp"

namespace fs = std::filesystem;

TEST_CASE("pack: one folder that generates the same; info says what a folder is") {
  const OfficialWorkplace w;
  const auto sizes = official::small();
  official::write_mdm_run(w / "mdm", sizes);
  official::write_clip(w / "mdm/clip", sizes);
  CHECK(w.run({"pack", "mdm", "-o", "packed"}).code == 2);  // without a licence
  const std::string said =
      w.did({"pack", "mdm", "-o", "packed", "--license", "MIT", "--provenance", "drawn", "--with-text-encoder"});
  for (const char* part :
       {"model of                 mdm", "license                  MIT", "text encoder             clip",
        "guoh3dfeats, 263 numbers a frame, 20 frames per second", "cosine, 24 steps"})
    CHECK_MESSAGE(contains(said, part), said);
  const auto bvh = [&](const std::string& model, const std::string& out) {
    w.did({"generate", "--model", model, "--text", "walk", "--seconds", "1", "--steps", "2", "--out", out});
    return ml::read_file(w / (out + "/walk.bvh"));
  };
  CHECK(bvh("mdm", "a") == bvh("packed", "b"));
  const Outcome again = w.run({"pack", "mdm", "-o", "packed", "--license", "MIT", "--provenance", "drawn"});
  CHECK(again.code == 1);
  CHECK(contains(again.text, "packed exists already"));
  const std::string info = w.did({"info", "packed"});
  CHECK(contains(info, "license                  MIT"));
  CHECK(contains(info, "seqTransEncoder.layers.1.norm2.weight"));
  CHECK(contains(w.did({"info", "mdm"}), "model000475000.pt"));
}

TEST_CASE(
    "pack: ACTOR, TEMOS, TEACH, SINC, TM2T and MDM for actions; the folder generates the same with nothing else") {
  const OfficialWorkplace w;
  const auto teach = official::small_teach();
  const auto sinc = official::small_sinc();
  official::write_actor_run(w / "actor", official::small_actor());
  official::write_mdm_action_run(w / "mdm", official::small());
  official::write_temos_run(w / "temos", official::small_temos());
  official::write_lightning_run(w / "teach", official::teach(teach), teach, 30);
  official::write_lightning_run(w / "sinc", official::sinc(sinc), sinc, 30);
  official::write_temos_statistics(w / "of64", 64);
  official::write_temos_statistics(w / "of135", 135);
  official::write_text(w / "words/vocab.txt", official::bert_vocabulary);
  const std::string tm2t = official::write_tm2t_runs(w.path, official::small_tm2t()).string();
  const TemporaryFolder elsewhere;  // nothing is found beside it
  const auto made = [&](const std::string& model, std::vector<std::string> what) {
    what.insert(what.begin(), {"generate", "--model", model, "--seed", "4", "--out", "made"});
    w.did(what);
    const std::string bvh = ml::read_file(w / "made/walk.bvh");
    fs::remove_all(w / "made");
    return bvh;
  };
  const auto check_packs = [&](const std::string& run, const std::string& system, const std::vector<std::string>& what,
                               const std::vector<std::string>& sources) {
    CAPTURE(system);
    const auto joined = [](std::vector<std::string> a, const std::vector<std::string>& b) {
      a.insert(a.end(), b.begin(), b.end());
      return a;
    };
    const std::string packed = (elsewhere / system).string();
    const std::string said = w.did(joined(
        {"pack", run, "-o", packed, "--license", "drawn by us", "--provenance", "this test", "--with-text-encoder"},
        sources));
    CHECK_MESSAGE(contains(said, "license                  drawn by us"), said);
    CHECK(contains(w.did({"info", packed}), "provenance               this test"));
    CHECK(contains(ml::read_file(packed + "/config.json"), "\"system\": \"" + system + "\""));
    CHECK(made(packed, what) == made(run, joined(what, sources)));
    const std::string again = packed + "_again";  // such a folder is a run folder
    w.did(
        {"pack", packed, "-o", again, "--license", "drawn by us", "--provenance", "this test", "--with-text-encoder"});
    CHECK(ml::read_file(again + "/weights.safetensors") == ml::read_file(packed + "/weights.safetensors"));
    const auto config = [](const std::string& folder) {
      return nlohmann::json::parse(ml::read_file(folder + "/config.json"));
    };
    CHECK(config(again) == config(packed));  // its options in any order
  };
  const std::vector<std::string> action{"--action", "walk", "--seconds", "1"}, text{"--text", "walk", "--seconds", "1"};
  check_packs("actor", "actor", action, {});
  check_packs("mdm", "mdm", action, {});
  check_packs("temos", "temos", text, {"--statistics", "of64", "--text-encoder", "words"});
  check_packs("teach", "teach", text, {"--statistics", "of135", "--text-encoder", "words"});
  check_packs("sinc", "sinc", text, {"--statistics", "of135", "--text-encoder", "words"});
  check_packs(tm2t, "tm2t", {"--text", "walk"}, {});
  const auto refused = [&](const std::string& run, const std::string& message) {
    const Outcome out = w.run({"pack", run, "-o", "refused", "--license", "l", "--provenance", "p"});
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, message), out.text);
    CHECK(!fs::exists(w / "refused"));
  };
  refused("temos", "no statistics of the motions");
  refused("of64", "[motionlang.io.404]");
}

TEST_CASE("describe: the bundled model says what motions of the bundled weights do") {
  const OfficialWorkplace w;
  for (const char* text : {"walk backwards", "spin around"}) w.did({"generate", "--text", text});
  const std::string said = w.did({"describe", "out/walk_backwards.npz", "out/spin_around.npz"});
  CHECK_MESSAGE(contains(said, "backwards"), said);
  CHECK_MESSAGE(contains(said, "spin"), said);
}

TEST_CASE("describe: TM2T as published; a listing, JSON, a table that index and the trainings read, a packed folder") {
  const OfficialWorkplace w;
  const std::string model =
      (official::write_tm2t_runs(w.path, official::small_tm2t()).parent_path() / "M2T_EL2_DL1_NH2_PS").string();
  fs::create_directories(w / "clips/more");
  ml::write_bvh(w / "clips/walk.bvh", synthetic::walk({.frames = 60}));
  ml::write_bvh(w / "clips/more/long.bvh", synthetic::walk({.frames = 300, .turn = 0.5}));
  ml::write_bvh(w / "clips/short.bvh", synthetic::walk({.frames = 3}));

  const std::string said =
      w.did({"describe", "clips", "--model", model, "--beams", "3", "--top", "2", "-o", "captions.tsv"});
  CHECK_MESSAGE(contains(said, "0.00    3.00 s  clips/walk.bvh"), said);
  CHECK_MESSAGE(contains(said, "skipped: clips/short.bvh: [motionlang.shape.205]"), said);
  CHECK_MESSAGE(contains(said, "table    captions.tsv"), said);
  std::istringstream table(ml::read_file(w / "captions.tsv"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(table, line);) lines.push_back(line);
  REQUIRE(lines.size() >= 2);
  CHECK(lines[0].starts_with("# clip\tstart\tend\tparts\tcaptions, by "));

  const auto json = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"describe", "clips/walk.bvh", "clips/more/long.bvh", "--model", model, "--json"});
    const std::string text = w.did(more);
    return nlohmann::json::parse(text.substr(text.find("[\n")));
  };
  const auto best = json({"--beams", "3", "--top", "2"});
  REQUIRE(best.size() == 3);  // 300 frames at 20 a second are two parts
  CHECK(best[0].at("path") == "clips/walk.bvh");
  CHECK(best[1].at("start") == 0);
  CHECK(best[1].at("end") == best[2].at("start"));
  CHECK(best[2].at("end").get<double>() == doctest::Approx(15));
  for (const auto& motion : best) {
    const auto& texts = motion.at("descriptions");
    CHECK((texts.size() == 1 || texts.size() == 2));
    for (const auto& d : texts) CHECK(d.at("log_probability").get<double>() < 0);
    for (std::size_t i = 1; i < texts.size(); ++i) CHECK(texts[i].at("text") != texts[0].at("text"));
  }
  // of drawn words only those of the vocabulary, the same for the same seed
  const auto drawn = json({"--sample", "--top", "4", "--seed", "3"});
  CHECK(drawn == json({"--sample", "--top", "4", "--seed", "3"}));
  CHECK(drawn != json({"--sample", "--top", "4", "--seed", "4"}));
  for (const auto& d : drawn[0].at("descriptions")) {
    std::istringstream words(d.at("text").get<std::string>());
    for (std::string word; words >> word;)
      CHECK(std::find(official::tm2t_words.begin(), official::tm2t_words.end(), word) != official::tm2t_words.end());
  }
  // nothing is left to draw
  CHECK(json({"--sample", "--top-k", "1"}) == json({"--sample", "--top-k", "1", "--seed", "9"}));

  // features are read as they are, and a packed folder says the same with nothing beside it
  w.did({"convert", "clips/walk.bvh", "rows.npy", "--features", "guoh3d"});
  const auto of = [&](const std::string& file, const std::string& folder) {
    const std::string text = w.did({"describe", file, "--model", folder, "--json"});
    return nlohmann::json::parse(text.substr(text.find("[\n"))).at(0).at("descriptions").at(0);
  };
  CHECK(of("rows.npy", model).at("text") == of("clips/walk.bvh", model).at("text"));
  w.did(
      {"pack", model, "-o", "packed", "--license", "drawn by us", "--provenance", "this test", "--with-text-encoder"});
  fs::rename(w / "glove", w / "words");
  fs::rename(w / "checkpoints", w / "elsewhere");
  CHECK(of("rows.npy", "packed").at("text").is_string());

  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& message) {
    const Outcome out = w.run(arguments);
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  refused({"describe", "clips/short.bvh", "--model", "packed"}, "[motionlang.shape.205]");
  const Outcome twice = w.run({"describe", "clips", "clips", "--model", "packed", "-o", "x.tsv"});
  CHECK_MESSAGE((twice.code == 2 && contains(twice.text, "would both be 'more/long.bvh' in the table")), twice.text);
  fs::create_directories(w / "nothing");
  refused({"describe", "nothing", "--model", "packed"}, "describe: no motion file in nothing");
  refused({"describe", "clips", "--model", "elsewhere/t2m/T2M_Seq2Seq"},
          "not TM2T's transformer from motions to texts");
  CHECK(w.run({"describe", "clips", "--model", "packed", "--sample", "--beams", "2"}).code == 2);
  CHECK(w.run({"describe", "clips", "--model", "packed", "--top", "0"}).code == 2);
  const std::string help = w.did({"describe", "--help"});
  for (const char* option :
       {"input", "--model", "--tokenizer", "--text-encoder", "--out", "--top", "--beams", "--sample", "--top-k",
        "--seed", "--json", "--scale", "--rate", "--up", "--threads", "--precision"})
    CHECK_MESSAGE(contains(help, option), option);
}

TEST_CASE("info: what the folders of ACTOR, TEMOS, TEACH, TM2T and MDM for actions hold") {
  const OfficialWorkplace w;
  const auto says = [&](const std::string& folder, std::initializer_list<const char*> lines) {
    const std::string said = w.did({"info", folder});
    for (const char* line : lines) CHECK_MESSAGE(contains(said, line), said.substr(0, 2000));
  };
  official::write_actor_run(w / "actor", official::small_actor());
  says("actor", {"actions                  12 classes of humanact12", "25 rows of 6 numbers a frame (rot6d)",
                 "encoder tokens for each class, decoder transformer; latent 16, feed-forward 24, 2 layers, 4 heads"});
  official::write_temos_run(w / "temos", official::small_temos());
  says("temos", {"model of                 temos", "64 numbers a frame, 12.5 frames per second",
                 "states of 64 numbers, DistilBERT in the checkpoint",
                 "motion encoder transformer, decoder transformer, latent 16"});
  const auto teach = official::small_teach();
  official::write_lightning_run(w / "teach", official::teach(teach), teach, 30);
  says("teach", {"model of                 teach", "135 numbers a frame, 30 frames per second"});
  official::write_mdm_action_run(w / "mdm", official::small());
  says("mdm", {"actions                  12 classes", "cosine, 24 steps"});
  const std::string run = official::write_tm2t_runs(w.path, official::small_tm2t()).string();
  says(run, {"from texts to motions", "recurrent, 1 layer of 12, early attention; writes 13 symbols"});
  const fs::path golden = fs::path(tests_folder()) / "golden/cases/containers";
  says((golden / "tmr_run").string(), {"system                   tmr", "not a whole model", "motion_encoder."});
  says((golden / "actor_run").string(), {"12 classes of humanact12", "encoder.muQuery"});
  says((fs::path(run).parent_path() / "M2T_EL2_DL1_NH2_PS").string(),
       {"from motions to texts", "transformer of width 8, 2 + 1 layers; writes 8 symbols"});
  says((fs::path(run).parent_path() / "VQVAEV3").string(),
       {"motion tokenizer", "263 numbers a frame", "10 codes, 2 halvings of the length, 2 residual blocks"});
}

TEST_CASE("embed: a cache in the layout of TMR and STMC") {
  const OfficialWorkplace w;
  const auto sizes = official::small();
  official::write_clip(w / "clip", sizes);
  ml::write_file(w / "texts.txt", std::string_view("walk\n\na walk\nwalk\n"));
  CHECK(contains(w.did({"embed", "texts.txt", "--encoder", "clip", "-o", "text_embeddings", "--name", "ViT-B/32",
                        "--pooling", "end"}),
                 "3 texts, rows of 12 numbers"));
  const auto cache = ml::EmbeddingCache::read(w / "text_embeddings", "ViT-B/32");
  CHECK((cache.count() == 3 && cache.width() == 12 && cache.contains("") && cache.contains("a walk")));
  const auto encoder = official::clip_encoder(sizes, ml::clip_sentences());
  const std::vector<std::string> texts{"a walk"};
  const auto wanted = encoder.encode<official::B>(std::span<const std::string>(texts)).tokens.rows;
  const auto found = cache.find("a walk");
  REQUIRE(found.size() == 12);
  for (std::size_t i = 0; i < 12; ++i) CHECK(found[i] == doctest::Approx(wanted.span()[i]).epsilon(1e-5));

  w.did({"embed", "texts.txt", "--encoder", "clip/", "-o", "named"});
  CHECK(ml::EmbeddingCache::read(w / "named", "clip").count() == 3);
  w.did({"embed", "texts.txt", "--encoder", "clip/ViT-B-32.pt", "-o", "tokens", "--name", "clip", "--no-empty"});
  const auto tokens = ml::EmbeddingCache::read(w / "tokens", "clip");
  CHECK((tokens.count() == 2 && tokens.width() == 64 && tokens.find("walk").size() == 3 * 64));
  CHECK(w.run({"embed", "texts.txt", "--encoder", "nowhere", "-o", "x"}).code == 2);
}
