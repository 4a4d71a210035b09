// The command train-evaluator, motions judged by its networks, and these networks as a model that retrieves.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/guo_evaluator_file.hpp>

#include "babel_sequences.hpp"
#include "described_walks.hpp"

TEST_CASE("train-evaluator: both stages learn and go on with the same numbers; the networks judge, and retrieve") {
  const TemporaryFolder place;
  write_walks((place / "h3d").string());
  const auto train = [&](const std::string& stage, const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> arguments{"train-evaluator", "--stage", stage,   "--data", "h3d",
                                       "--preset",        "small",   "--out", out};
    for (const char* a :
         {"optimiser.schedule=constant", "optimiser.warmup=0", "optimiser.lr=0.003", "movement.hidden=16",
          "movement.latent=16", "matching.text_hidden=16", "matching.motion_hidden=24", "matching.embedding=16",
          "matching.word_width=8", "validation.every=5"})
      arguments.insert(arguments.end(), {"--set", a});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, place.path);
  };
  const auto checkpoint = [&](const std::string& out) {
    return ml::SafetensorsFile::open(place / (out + "/checkpoint.safetensors"));
  };
  struct Stage {
    std::string name, file;
    std::vector<std::string> sources;
    int half, whole;  // epochs
  };
  const std::vector<Stage> stages{
      {"movement", "latest.tar", {"--set", "optimiser.batch=64"}, 3, 8},
      {"matching", "finest.tar", {"--movement", "movement/model", "--set", "optimiser.batch=4"}, 20, 120}};
  for (const Stage& s : stages) {
    CAPTURE(s.name);
    const auto with = [&](int epochs) {
      auto more = s.sources;
      more.insert(more.end(), {"--set", "optimiser.epochs=" + std::to_string(epochs)});
      return more;
    };
    const auto done = train(s.name, s.name, with(s.whole));
    REQUIRE_MESSAGE(done.code == 0, done.text);
    const auto losses = ml::values_of<float>(checkpoint(s.name).tensor("losses"));
    const std::size_t part = losses.size() / 8;
    CHECK(mean(std::span(losses).last(part)) < 0.8 * mean(std::span(losses).first(part)));
    REQUIRE(train(s.name, "halves", with(s.half)).code == 0);
    const auto rest = train(s.name, "halves", with(s.whole));
    REQUIRE_MESSAGE(rest.code == 0, rest.text);
    CHECK(contains(rest.text, "continuing at step "));
    CHECK(ml::values_of<float>(checkpoint("halves").tensor("losses")) == losses);
    CHECK(ml::read_file(place / ("halves/model/" + s.file)) == ml::read_file(place / (s.name + "/model/" + s.file)));
    std::filesystem::remove_all(place / "halves");
  }
  for (const char* name : {"finest.tar", "meta/mean.npy", "meta/std.npy", "glove/our_vab_data.npy", "config.json"})
    CHECK_MESSAGE(std::filesystem::exists(place / "matching/model" / name), name);
  CHECK(contains(run({"info", "matching/model"}, place.path).text, "guo evaluator"));

  write_distilbert(place / "sentences");
  const auto with_likeness =
      run({"evaluate", "matching/model", "--data", "h3d", "--part", "training", "--sentence-encoder", "sentences"},
          place.path);
  CHECK_MESSAGE((with_likeness.code == 0 && contains(with_likeness.text, "alike")), with_likeness.text);

  // what it has learnt by heart it finds
  const auto found = run({"evaluate", "matching/model", "--data", "h3d", "--part", "training"}, place.path);
  REQUIRE_MESSAGE(found.code == 0, found.text);
  CHECK(contains(found.text, "6 motions of the training part, by the nearest vectors of matching/model ("));
  CHECK_MESSAGE(contains(found.text, "  all                     100.00 100.00"), found.text);

  // motions of another system
  const auto made = train_tiny("train-temos", place.path, {"--data", "h3d"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  std::filesystem::rename(place / "out", place / "temos");
  const std::vector<std::string> judge{"evaluate", "temos/model", "--data",    "h3d", "--part",      "training",
                                       "--seeds",  "2",           "--repeats", "0",   "--evaluator", "matching/model"};
  const auto judged = run(judge, place.path);
  REQUIRE_MESSAGE(judged.code == 0, judged.text);
  CHECK_MESSAGE(contains(judged.text, "6 motions of the training part in batches of 6, drawn 2 times"), judged.text);
  const std::string fingerprint = ml::guo_fingerprint(place / "matching/model/finest.tar");
  CHECK_MESSAGE(contains(judged.text, "judged by matching/model (" + fingerprint + ")"), judged.text);
  CHECK_MESSAGE(contains(judged.text, "  recorded                 1.000 +-0.000"), judged.text);
  const auto generated = judged.text.find("\n  generated");
  REQUIRE_MESSAGE(generated != judged.text.npos, judged.text);
  CHECK(contains(judged.text.substr(generated), " -"));  // no multimodality
  CHECK(run(judge, place.path).text.substr(0, generated) == judged.text.substr(0, generated));
  auto varied = judge;
  varied[9] = "11", varied[7] = "1";
  const auto all = run(varied, place.path);
  REQUIRE_MESSAGE(all.code == 0, all.text);
  CHECK(contains(all.text, "multimodality of 6 texts"));

  // and of all others: SINC and TEACH learn from BABEL, the rest from the same walks, and STMC is the bundled one
  const Sequences sequences;
  std::vector<std::string> models{MOTIONLANG_EXAMPLES "/models/stmc_free.safetensors"};
  for (const std::string system : {"sinc", "teach"}) {
    const auto trained = sequences.train("train-" + system, system, {"--babel", "babel.json", "--splits", "splits"});
    REQUIRE_MESSAGE(trained.code == 0, trained.text);
    models.push_back((sequences / (system + "/model")).string());
  }
  for (const std::string system : {"tmr", "mdm", "motiondiffuse"}) {
    std::vector<std::string> more{"--data", "h3d"};
    if (system != "tmr") {
      for (const char* a : {"text.ff_size=8", "text.num_layers=1", "text.num_heads=2", "diffusion.steps=24"})
        more.insert(more.end(), {"--set", a});
    }
    if (system == "motiondiffuse") {
      for (const char* a : {"network.text_latent_dim=8", "network.text_ff_size=8", "network.text_num_heads=2"})
        more.insert(more.end(), {"--set", a});
    }
    const auto trained = train_tiny("train-" + system, place.path, more);
    REQUIRE_MESSAGE(trained.code == 0, system, ": ", trained.text);
    std::filesystem::rename(place / "out", place / system);
    models.push_back(system + "/model");
  }
  for (const std::string& model : models) {
    CAPTURE(model);
    const auto of_model = run({"evaluate", model, "--data", "h3d", "--part", "training", "--seeds", "1", "--repeats",
                               "0", "--steps", "2", "--evaluator", "matching/model"},
                              place.path);
    REQUIRE_MESSAGE(of_model.code == 0, of_model.text);
    CHECK_MESSAGE(contains(of_model.text, "\n  generated"), of_model.text);
  }

  // its rows in TMR's table of generated motions
  const auto searched = run({"evaluate", "matching/model", "--data", "h3d", "--part", "training", "--synthesis",
                             "--generator", "temos/model"},
                            place.path);
  REQUIRE_MESSAGE(searched.code == 0, searched.text);
  CHECK(contains(searched.text, "\n    generated"));

  // motions of another program: the recorded ones themselves, by their names
  const auto others = run({"evaluate", "matching/model", "--data", "h3d", "--part", "training", "--seeds", "2",
                           "--made", "h3d/new_joint_vecs", "--synthesis"},
                          place.path);
  REQUIRE_MESSAGE(others.code == 0, others.text);
  const auto judged_others = others.text.find("\n  generated");
  REQUIRE_MESSAGE(judged_others != others.text.npos, others.text);
  CHECK(contains(others.text.substr(judged_others, others.text.find('\n', judged_others + 1) - judged_others),
                 " -"));  // one sample of each: no multimodality
  const auto row = [&](const char* name) {
    const auto at = others.text.rfind(name);
    return at == others.text.npos ? name : others.text.substr(at + 12, others.text.find('\n', at + 1) - at - 12);
  };
  CHECK_MESSAGE(contains(row("\n    generated"), " 100.00"), others.text);

  const auto refused = [&](const std::vector<std::string>& arguments, int code, const char* message) {
    const auto out = run(arguments, place.path);
    CHECK(out.code == code);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  varied[9] = "5";
  refused(varied, 1, "[motionlang.config.101] multimodality by 5 motions of a text: more than 10 are needed");
  refused({"evaluate", "matching/model"}, 2, "--data is needed");
  refused({"evaluate", "matching/model", "--data", "h3d", "--synthesis"}, 2, "needs --generator");
  refused({"train-evaluator", "--stage", "matching", "--data", "h3d", "--preset", "small"}, 2,
          "--movement is required");
  refused(
      {"train-evaluator", "--stage", "movement", "--data", "h3d", "--preset", "small", "--set", "movement.window=10"},
      1, "window is 10, expected a multiple of 4");
  refused({"train-evaluator", "--stage", "movement", "--print-config"}, 0, "\"window\": 24");
}
