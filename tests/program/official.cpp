// The motionlang program on folders as the official repositories leave them: generate, pack, info, embed.
#include <doctest/doctest.h>

#include <motionlang/io/embedding_cache.hpp>

#include "../support/official_tm2t.hpp"
#include "../support/official_vaes.hpp"
#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

struct Workplace : TemporaryFolder {
  Outcome run(const std::vector<std::string>& arguments) const { return ::run(arguments, path); }
  /// Runs a command that has to go well, and gives what it said.
  std::string did(const std::vector<std::string>& arguments) const {
    const Outcome o = run(arguments);
    CHECK_MESSAGE(o.code == 0, o.text);
    return o.text;
  }
  /// Frames and joints of the positions that a generation wrote.
  std::vector<ml::Index> joints(const std::string& file) const { return ml::read_npy(path / file).shape; }
};

}  // namespace

TEST_CASE("generate: folders of STMC, MDM and MotionDiffuse, from a text and from a timeline") {
  const Workplace w;
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
    w.did({"generate", "--model", model, "--text", "A walk, slowly!", "--seconds", "1.5", "--out", model + "_out", "--steps", "2"});
    for (const char* end : {".bvh", ".glb", ".npz", ".svg", ".html"}) CHECK(fs::exists(w / (model + "_out/A_walk_slowly" + end)));
    CHECK(w.joints(model + "_out/A_walk_slowly.npy") == std::vector<ml::Index>{30, 24, 3});
  }
  ml::write_file(w / "two.txt", std::string_view("walk # 0 # 1 # legs\nwave # 0.2 # 0.8 # right arm\n"));
  w.did({"generate", "--model", "mdm", "--timeline", "two.txt", "--steps", "2"});
  CHECK(w.joints("out/two.npy") == std::vector<ml::Index>{20, 24, 3});
  const Outcome longer = w.run({"generate", "--model", "mdm", "--text", "walk", "--seconds", "12"});
  CHECK(longer.code == 3);
  CHECK(contains(longer.text, "the denoiser accepts 196"));
  CHECK(w.run({"generate", "--model", "mdm", "--text", "walk", "--timeline", "two.txt"}).code == 2);
  CHECK(w.run({"generate", "--model", "mdm"}).code == 2);
}

TEST_CASE("pack: one folder that generates the same; info says what a folder is") {
  const Workplace w;
  const auto sizes = official::small();
  official::write_mdm_run(w / "mdm", sizes);
  official::write_clip(w / "mdm/clip", sizes);
  CHECK(w.run({"pack", "mdm", "-o", "packed"}).code == 2);  // without a licence
  const std::string said = w.did({"pack", "mdm", "-o", "packed", "--license", "MIT", "--provenance", "drawn", "--with-text-encoder"});
  for (const char* part : {"model of                 mdm", "license                  MIT", "text encoder             clip",
                           "guoh3dfeats, 263 numbers a frame, 20 frames per second", "cosine, 24 steps"})
    CHECK_MESSAGE(contains(said, part), said);
  const auto bvh = [&](const std::string& model, const std::string& out) {
    w.did({"generate", "--model", model, "--text", "walk", "--seconds", "1", "--steps", "2", "--out", out});
    return ml::read_file(w / (out + "/walk.bvh"));
  };
  CHECK(bvh("mdm", "a") == bvh("packed", "b"));
  const Outcome again = w.run({"pack", "mdm", "-o", "packed", "--license", "MIT", "--provenance", "drawn"});
  CHECK(again.code == 1);
  CHECK(contains(again.text, "packed is there already"));
  const std::string info = w.did({"info", "packed"});
  CHECK(contains(info, "license                  MIT"));
  CHECK(contains(info, "seqTransEncoder.layers.1.norm2.weight"));
  CHECK(contains(w.did({"info", "mdm"}), "model000475000.pt"));
}

TEST_CASE("generate: ACTOR takes actions, TEMOS a text") {
  const Workplace w;
  official::write_actor_run(w / "actor", official::small_actor());
  w.did({"generate", "--model", "actor", "--action", "walk", "--seconds", "1"});
  CHECK(w.joints("out/walk.npy") == std::vector<ml::Index>{20, 24, 3});
  w.did({"generate", "--model", "actor", "--action", "1", "--seconds", "1"});
  CHECK(ml::read_file(w / "out/walk.bvh") == ml::read_file(w / "out/1.bvh"));
  const Outcome dance = w.run({"generate", "--model", "actor", "--action", "dance"});
  CHECK(dance.code == 1);
  CHECK(contains(dance.text, "action 'dance' is none of 0 ... 11; they are called warm_up, walk"));
  ml::write_file(w / "two.txt", std::string_view("walk # 0 # 1 # legs\nrun # 0.2 # 0.8 # right arm\n"));
  CHECK(w.run({"generate", "--model", "actor", "--timeline", "two.txt"}).code == 3);

  official::write_temos_run(w / "temos", official::small_temos());
  official::write_temos_statistics(w / "statistics", 64);
  official::write_text(w / "words/vocab.txt", official::bert_vocabulary);
  w.did({"generate", "--model", "temos", "--text", "a walk", "--seconds", "2", "--statistics", "statistics", "--text-encoder", "words"});
  CHECK(w.joints("out/a_walk.npy") == std::vector<ml::Index>{25, 21, 3});
}

TEST_CASE("generate: TEACH takes texts one after the other, SINC texts at the same time") {
  const Workplace w;
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
}

TEST_CASE("generate: MDM for actions, and TM2T, which decides itself how long a motion is") {
  const Workplace w;
  official::write_mdm_action_run(w / "mdm", official::small());
  w.did({"generate", "--model", "mdm", "--action", "walk", "--seconds", "2", "--steps", "3"});
  CHECK(w.joints("out/walk.npy") == std::vector<ml::Index>{40, 24, 3});
  w.did({"generate", "--model", "mdm", "--action", "1", "--seconds", "2", "--steps", "3"});
  CHECK(ml::read_file(w / "out/walk.bvh") == ml::read_file(w / "out/1.bvh"));
  const Outcome longer = w.run({"generate", "--model", "mdm", "--action", "walk", "--seconds", "4"});
  CHECK(longer.code == 3);
  CHECK(contains(longer.text, "'walk' has 80 frames, the model makes 60"));
  CHECK(contains(w.run({"generate", "--model", "mdm", "--action", "walk", "--backend", "reference"}).text, "generated with backend 'eigen'"));

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

TEST_CASE("info: what the folders of ACTOR, TEMOS, TEACH, TM2T and MDM for actions hold") {
  const Workplace w;
  const auto says = [&](const std::string& folder, std::initializer_list<const char*> lines) {
    const std::string said = w.did({"info", folder});
    for (const char* line : lines) CHECK_MESSAGE(contains(said, line), said.substr(0, 2000));
  };
  official::write_actor_run(w / "actor", official::small_actor());
  says("actor", {"actions                  12 classes of humanact12", "25 rows of 6 numbers a frame (rot6d)",
                 "encoder tokens for each class, decoder transformer; latent 16, feed-forward 24, 2 layers, 4 heads"});
  official::write_temos_run(w / "temos", official::small_temos());
  says("temos", {"model of                 temos", "64 numbers a frame, 12.5 frames per second",
                 "states of 64 numbers, DistilBERT in the checkpoint", "motion encoder transformer, decoder transformer, latent 16"});
  const auto teach = official::small_teach();
  official::write_lightning_run(w / "teach", official::teach(teach), teach, 30);
  says("teach", {"model of                 teach", "135 numbers a frame, 30 frames per second"});
  official::write_mdm_action_run(w / "mdm", official::small());
  says("mdm", {"actions                  12 classes", "cosine, 24 steps"});
  const std::string run = official::write_tm2t_runs(w.path, official::small_tm2t()).string();
  says(run, {"from texts to motions", "recurrent, 1 layers of 12, early attention; writes 13 symbols"});
  const fs::path golden = fs::path(__FILE__).parent_path().parent_path() / "golden/cases/containers";
  says((golden / "tmr_run").string(), {"system                   tmr", "not a whole model", "motion_encoder."});
  says((golden / "actor_run").string(), {"12 classes of humanact12", "encoder.muQuery"});
  says((fs::path(run).parent_path() / "VQVAEV3").string(), {"motion tokenizer", "263 numbers a frame", "10 codes, 2 halvings of the length, 2 residual blocks"});
}

TEST_CASE("embed: a cache in the layout of TMR and STMC") {
  const Workplace w;
  const auto sizes = official::small();
  official::write_clip(w / "clip", sizes);
  ml::write_file(w / "texts.txt", std::string_view("walk\n\na walk\nwalk\n"));
  CHECK(contains(w.did({"embed", "texts.txt", "--encoder", "clip", "-o", "text_embeddings", "--name", "ViT-B/32", "--pooling", "end"}),
                 "3 texts, rows of 12 numbers"));
  const auto cache = ml::EmbeddingCache::read(w / "text_embeddings", "ViT-B/32");
  CHECK((cache.count() == 3 && cache.width() == 12 && cache.contains("") && cache.contains("a walk")));
  const auto encoder = official::clip_encoder(sizes, ml::clip_sentences());
  const std::vector<std::string> texts{"a walk"};
  const auto wanted = encoder.encode<official::B>(std::span<const std::string>(texts)).tokens.rows;
  const auto found = cache.find("a walk");
  REQUIRE(found.size() == 12);
  for (std::size_t i = 0; i < 12; ++i) CHECK(found[i] == doctest::Approx(wanted.span()[i]).epsilon(1e-5));

  w.did({"embed", "texts.txt", "--encoder", "clip/ViT-B-32.pt", "-o", "tokens", "--name", "clip", "--no-empty"});
  const auto tokens = ml::EmbeddingCache::read(w / "tokens", "clip");
  CHECK((tokens.count() == 2 && tokens.width() == 64 && tokens.find("walk").size() == 3 * 64));
  CHECK(w.run({"embed", "texts.txt", "--encoder", "nowhere", "-o", "x"}).code == 2);
}
