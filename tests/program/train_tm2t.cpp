// The command train-tm2t, and errors on the joints of MMM.
#include <doctest/doctest.h>

#include <array>
#include <sstream>

#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/kinematics/root_motion.hpp>
#include <motionlang/metrics/ape_ave.hpp>
#include <motionlang/train/temos_evaluation.hpp>
#include <motionlang/weights/text_motion_model.hpp>

#include "../support/glove_files.hpp"
#include "../support/temporary_folder.hpp"
#include "training_clips.hpp"

TEST_CASE("errors of TEMOS on MMM's joints: KIT's units as millimetres, the heading of knees and elbows") {
  const TemporaryFolder place;
  const std::string kit = (place / "kit").string();
  add_walk(kit, "00001", 60, "kit", ml::kit_ml_form, {.steps_per_second = 1.1, .turn = 0.8});
  add_walk(kit, "00002", 40, "kit", ml::kit_ml_form);
  ml::write_ids(kit + "/train.txt", std::vector<std::string>{"00001"});
  ml::write_ids(kit + "/test.txt", std::vector<std::string>{"00002"});
  const auto trained = train_tiny("train-temos", place.path, {"--data", "kit", "--set", "optimiser.epochs=1"});
  REQUIRE_MESSAGE(trained.code == 0, trained.text);
  const auto measured = run({"evaluate", "out/model", "--data", "kit", "--samples", "1"}, place.path);
  REQUIRE_MESSAGE(measured.code == 0, measured.text);
  CHECK(contains(measured.text, "as TEMOS measures MMM's joints"));
  const auto at = measured.text.find("  random clip");  // the only one to train on
  REQUIRE_MESSAGE(at != std::string::npos, measured.text);
  std::istringstream numbers(measured.text.substr(at + 13));
  std::array<double, 8> said{};
  for (double& x : said) REQUIRE_MESSAGE(static_cast<bool>(numbers >> x), measured.text);

  const auto joints = [&](const std::string& id) {  // in KIT's units
    const auto read = ml::HumanMl3dFolder(kit, ml::kit_ml_form).load(id).features;
    const std::vector<double> rows(read.begin(), read.end());
    return ml::joints_at_rate(ml::guoh3d_joints(std::span<const double>(rows), 21), 21, 12.5, ml::temos_rate);
  };
  const auto errors = [&](const ml::RifkeVariant& variant) {
    ml::ApeAveMetric<double> metric(variant, 0.001);
    metric.add(joints("00001"), joints("00002"));
    const auto e = metric.result();
    std::array<double, 8> out{};
    std::size_t i = 0;
    for (const ml::PositionErrors* p : {&e.ape, &e.ave}) {
      for (const double x : {p->root, p->trajectory, p->mean_local(), p->mean_joints()}) out[i++] = x;
    }
    return out;
  };
  const auto published = errors(ml::temos_rifke());
  auto hips_and_shoulders = ml::temos_rifke();
  hips_and_shoulders.across = {{{16, 11}, {8, 5}}};
  const auto others = errors(hips_and_shoulders);
  for (std::size_t i = 0; i < said.size(); ++i) CHECK(std::abs(said[i] - published[i]) < 6e-4);  // of three digits
  CHECK(std::abs(published[2] - others[2]) > 1.5e-3);
}

TEST_CASE(
    "train-tm2t: a stage after the other; each learns, goes on with the same numbers, and describes and generates") {
  const Clips clips;
  const auto train = [&](const std::string& stage, const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> arguments{"train-tm2t", "--stage",  stage,   "--data",     ".",           "--out",
                                       out,          "--preset", "small", "--captions", "captions.tsv"};
    for (const char* a : {"data.min_seconds=0.5",
                          "data.test_share=0.25",
                          "data.validation_share=0.25",
                          "data.mirror=false",
                          "optimiser.batch=4",
                          "optimiser.schedule=constant",
                          "optimiser.warmup=0",
                          "optimiser.lr=0.005",
                          "tokenizer.channels=[8, 8]",
                          "tokenizer.codes=12",
                          "tokenizer.residual_blocks=1",
                          "tokenizer.window=28",
                          "tokenizer.adversarial=0.5",
                          "tokenizer.adversarial_from=1",
                          "tokenizer.discriminator=8",
                          "motion_to_text.latent_dim=16",
                          "motion_to_text.ff_size=16",
                          "motion_to_text.num_layers=1",
                          "motion_to_text.num_heads=2",
                          "text_to_motion.text_hidden=8",
                          "text_to_motion.motion_hidden=16",
                          "text_to_motion.word_width=8",
                          "text_to_motion.alignment_from=1"})
      arguments.insert(arguments.end(), {"--set", a});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, clips.path);
  };
  struct Stage {
    std::string name, measure;
    std::vector<std::string> terms, sources;
    int half, whole;  // epochs
  };
  const std::vector<Stage> stages{
      {"tokenizer", "perplexity", {"rec", "emb", "adv"}, {}, 2, 4},
      {"motion-to-text", "loss of a word", {"words"}, {"--tokenizer", "tokenizer/model"}, 30, 60},
      {"text-to-motion", "loss of a token", {"tokens", "words"}, {"--describer", "motion-to-text/model"}, 25, 60}};
  for (const Stage& s : stages) {
    CAPTURE(s.name);
    const auto epochs = [&](int n) {
      auto more = s.sources;
      more.insert(more.end(), {"--set", "optimiser.epochs=" + std::to_string(n)});
      return more;
    };
    const auto done = train(s.name, s.name, epochs(s.whole));
    REQUIRE_MESSAGE(done.code == 0, done.text);
    CHECK(contains(done.text, "4 motions to train on, 2 for validation, 2 for tests"));
    CHECK(contains(ml::read_file(clips / (s.name + "/loss.svg")), s.measure));
    CHECK(clips.terms(s.name) == s.terms);
    const auto losses = clips.losses(s.name);
    const std::size_t tenth = losses.size() / 10;
    CHECK(mean(std::span(losses).last(tenth)) < 0.9 * mean(std::span(losses).first(tenth)));
    const std::string halves = s.name + "_halves";
    REQUIRE(train(s.name, halves, epochs(s.half)).code == 0);
    const auto rest = train(s.name, halves, epochs(s.whole));
    REQUIRE_MESSAGE(rest.code == 0, rest.text);
    CHECK(contains(rest.text, "continuing at step "));
    CHECK(clips.losses(halves) == losses);
    CHECK(clips.weights(halves) == clips.weights(s.name));
  }

  const auto did = [&](const std::vector<std::string>& arguments) {
    const auto out = run(arguments, clips.path);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return out.text;
  };
  for (const char* line : {"from texts to motions", "from motions to texts", "motion tokenizer", "12 codes, 2 halvings",
                           "writes 15 symbols", "license                  not stated"})
    CHECK_MESSAGE(contains(did({"info", "text-to-motion/model"}), line), line);
  // a clip to train on is described by one of its captions, by the model of either stage, and the table can be trained
  // on
  const auto file = ml::SafetensorsFile::open(clips / "motion-to-text/checkpoint.safetensors");
  CHECK(contains(file.metadata().at("words"), "someone\nturns\nwalks\n"));
  const std::string said =
      did({"describe", "clip0.bvh", "clip1.bvh", "clip2.bvh", "clip3.bvh", "clip4.bvh", "clip5.bvh", "clip6.bvh",
           "clip7.bvh", "--model", "motion-to-text/model", "-o", "described.tsv"});
  CHECK((contains(said, "\"someone walks\"") || contains(said, "\"a person walks ahead\"")));
  CHECK((contains(said, "\"someone turns\"") || contains(said, "\"a person turns left\"")));
  const std::string table = ml::read_file(clips / "described.tsv");
  did({"describe", "clip0.bvh", "--model", "text-to-motion/model", "-o", "one.tsv"});
  const std::string one = ml::read_file(clips / "one.tsv"), line = one.substr(one.find('\n'));
  CHECK_MESSAGE(contains(table, line), line);
  did({"train-temos", "--data", ".", "--captions", "described.tsv", "--preset", "small", "--out", "from_described",
       "--set", "optimiser.epochs=1", "--set", "network.latent_dim=8", "--set", "network.ff_size=8", "--set",
       "text.width=8", "--set", "data.min_seconds=0.5"});

  did({"generate", "--model", "text-to-motion/model", "--text", "a person turns left", "--out", "made"});
  const auto made = ml::read_npy(clips / "made/a_person_turns_left.npy").shape;
  CHECK((made.size() == 3 && made[0] > 0 && made[0] % 4 == 0));

  // measured against what people said: what it has learnt by heart, it says
  const std::string scores =
      did({"evaluate", "motion-to-text/model", "--data", ".", "--captions", "captions.tsv", "--part", "training"});
  for (const char* text : {"4 motions of the training part, 4 to describe", "BLEU-4  ROUGE-L    CIDEr",
                           "  a random text of the training part"})
    CHECK_MESSAGE(contains(scores, text), scores);
  const auto described = scores.find("  described");
  REQUIRE(described != scores.npos);
  CHECK_MESSAGE(scores.substr(described, scores.find('\n', described) - described).find("  100.00") != scores.npos,
                scores);

  // another program says for each what people said first
  std::filesystem::create_directory(clips / "others");
  std::istringstream captions(ml::read_file(clips / "captions.tsv"));
  for (std::string row; std::getline(captions, row);) {
    if (row.starts_with('#')) continue;
    const std::string words = row.substr(row.rfind('\t') + 1);
    ml::write_file(clips / ("others/" + row.substr(0, row.find('\t')) + ".txt"), words.substr(0, words.find(" | ")));
  }
  const std::string beside = did({"evaluate", "motion-to-text/model", "--data", ".", "--captions", "captions.tsv",
                                  "--part", "training", "--made", "others"});
  const auto others = beside.find("  others ");
  REQUIRE_MESSAGE(others != beside.npos, beside);
  CHECK_MESSAGE(beside.substr(others, beside.find('\n', others) - others).find("  100.00") != beside.npos, beside);

  // the same, and by a language model: 100 of what is said word by word, and less of anything else
  write_distilbert(clips / "bert");
  std::vector<std::string> with_bert{
      "evaluate", "motion-to-text/model", "--data", ".", "--captions", "captions.tsv", "--part", "training", "--bert",
      "bert"};
  const std::string judged = did(with_bert);
  CHECK_MESSAGE(contains(judged, "BERTScore by layer 2 of 2 of bert, without a baseline"), judged);
  CHECK_MESSAGE(contains(judged, "BLEU-4  ROUGE-L    CIDEr  BERTScore"), judged);
  const auto numbers = [](const std::string& text, const std::string& row) {
    std::istringstream rest(text.substr(text.find("  " + row) + row.size() + 2));
    std::vector<double> out(7);
    for (double& x : out) rest >> x;
    return rest ? out : std::vector<double>(7);
  };
  for (const char* row : {"described", "a random text of the training part"}) {
    const auto found = numbers(judged, row);
    CHECK(found[6] != 0);
    CHECK_MESSAGE((found[6] == 100) == (found[4] == 100), judged);  // and so ROUGE-L
  }
  with_bert.insert(with_bert.end(), {"--bert-layer", "1"});
  const std::string of_first = did(with_bert);
  CHECK(contains(of_first, "BERTScore by layer 1 of 2 of bert"));
  CHECK((numbers(of_first, "described")[6] == 100) == (numbers(judged, "described")[4] == 100));
  with_bert.back() = "3";
  const auto too_deep = run(with_bert, clips.path);
  CHECK(too_deep.code == 1);
  CHECK_MESSAGE(contains(too_deep.text, "[motionlang.config.101] --bert-layer 3: bert has 2 layers"), too_deep.text);

  write_roberta(clips / "roberta");
  with_bert.resize(with_bert.size() - 3);
  with_bert.push_back("roberta");
  const std::string by_roberta = did(with_bert);
  CHECK_MESSAGE(contains(by_roberta, "BERTScore by layer 1 of 1 of roberta"), by_roberta);
  write_roberta(clips / "roberta-large", 24);
  with_bert.back() = "roberta-large";
  with_bert.insert(with_bert.end(), {"--bert-layer", "17", "--bert-baseline", "tm2t"});
  const std::string as_published = did(with_bert);
  CHECK_MESSAGE(contains(as_published, "BERTScore by layer 17 of 24 of roberta-large, with TM2T's baseline"),
                as_published);

  // lemmas of a data set, and word vectors of a folder
  const std::string set = (clips / "h3d").string();
  for (const char* id : {"000000", "000001"}) {
    add_walk(set, id, 60, "guoh3d", ml::humanml3d_form);
    auto clip = ml::HumanMl3dFolder(set).load(id);
    clip.captions.at(0).words = {{"person", "NOUN"}, {"walk", "VERB"}};
    ml::write_humanml3d_clip(set, clip);
  }
  ml::write_ids(set + "/train.txt", std::vector<std::string>{"000000", "000001"});
  const auto of_set = [&](const std::string& stage, std::vector<std::string> more) {
    std::vector<std::string> arguments{"train-tm2t", "--stage", stage,   "--preset",     "small",
                                       "--data",     "h3d",     "--out", "set_" + stage, "--fresh"};
    for (const char* a : {"optimiser.epochs=1", "tokenizer.channels=[4, 4]", "tokenizer.codes=6",
                          "motion_to_text.latent_dim=8", "motion_to_text.ff_size=8", "motion_to_text.num_layers=1",
                          "text_to_motion.text_hidden=4", "text_to_motion.motion_hidden=8", "tokenizer.window=32"})
      arguments.insert(arguments.end(), {"--set", a});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return did(arguments);
  };
  of_set("tokenizer", {});
  const auto words_of = [&](const std::string& out) { return clips.checkpoint(out).metadata().at("words"); };
  of_set("motion-to-text", {"--tokenizer", "set_tokenizer/model"});
  CHECK(words_of("set_motion-to-text") == "sos\neos\nunk\nperson\nwalk\n");
  const std::vector<std::string> known{"eos", "sos", "unk", "walk", "jump"};
  std::filesystem::create_directories(clips / "words");
  glove_files::write((clips / "words/our_vab").string(), known, known, std::vector<float>(15, 0.5f));
  of_set("motion-to-text", {"--tokenizer", "set_tokenizer/model", "--text-encoder", "words"});
  CHECK(words_of("set_motion-to-text") == "eos\nsos\nunk\nwalk\njump\n");
  of_set("text-to-motion", {"--describer", "set_motion-to-text/model"});
  CHECK(contains(did({"info", "set_text-to-motion/model"}), "word vectors of 3 numbers"));

  // the paper's baseline, a transformer that writes motions; and descriptions without motion tokens
  std::vector<std::string> baseline{"--tokenizer", "tokenizer/model"};
  for (const char* a :
       {"text_to_motion.network=transformer", "text_to_motion.latent_dim=16", "text_to_motion.ff_size=16",
        "text_to_motion.num_layers=1", "text_to_motion.num_heads=2", "optimiser.epochs=40"})
    baseline.insert(baseline.end(), {"--set", a});
  const auto transformer = train("text-to-motion", "transformer", baseline);
  REQUIRE_MESSAGE(transformer.code == 0, transformer.text);
  CHECK(clips.terms("transformer") == std::vector<std::string>{"tokens"});
  const auto learnt = clips.losses("transformer");
  CHECK(mean(std::span(learnt).last(8)) < 0.7 * mean(std::span(learnt).first(8)));
  CHECK(contains(did({"info", "transformer/model"}), "from texts to motions, by transformers"));
  did({"generate", "--model", "transformer/model", "--text", "a person turns left", "--out", "by_transformer"});
  CHECK(ml::read_npy(clips / "by_transformer/a_person_turns_left.npy").shape[0] % 4 == 0);
  const auto no_tokens =
      train("motion-to-text", "no_tokens",
            {"--tokenizer", "tokenizer/model", "--set", "motion_to_text.tokens=false", "--set", "optimiser.epochs=60"});
  REQUIRE_MESSAGE(no_tokens.code == 0, no_tokens.text);
  const auto of_features = clips.losses("no_tokens");
  CHECK(mean(std::span(of_features).last(8)) < 0.7 * mean(std::span(of_features).first(8)));
  const std::string featured =
      did({"evaluate", "no_tokens/model", "--data", ".", "--captions", "captions.tsv", "--part", "training"});
  CHECK_MESSAGE(contains(featured, "  described"), featured);
  const std::string rescaled = did({"evaluate", "motion-to-text/model", "--data", ".", "--captions", "captions.tsv",
                                    "--part", "training", "--bert", "bert", "--bert-baseline", "random"});
  CHECK_MESSAGE(contains(rescaled, "of bert, with the baseline "), rescaled);
  CHECK(std::abs(numbers(rescaled, "a random text of the training part")[6]) < 30);  // about 0 by its choice
  CHECK(numbers(rescaled, "described")[6] == 100);

  // tokens of motions, and what they stand for
  const std::string codes =
      did({"tokens", "clip0.bvh", "clip1.bvh", "--model", "tokenizer/model", "--page", "codes.html"});
  CHECK_MESSAGE(contains(codes, "clip0.bvh "), codes);
  CHECK_MESSAGE(contains(codes, " of 12 codes in use"), codes);
  CHECK(contains(ml::read_file(clips / "codes.html"), "code "));
  CHECK(run({"tokens", "--model", "tokenizer/model"}, clips.path).code == 2);

  // without inverse alignment; what is missing and what does not fit
  const auto alone = train(
      "text-to-motion", "alone",
      {"--tokenizer", "tokenizer/model", "--set", "text_to_motion.alignment=false", "--set", "optimiser.epochs=2"});
  REQUIRE_MESSAGE(alone.code == 0, alone.text);
  CHECK(clips.terms("alone") == std::vector<std::string>{"tokens"});
  const auto refused = [&](const std::string& stage, const std::vector<std::string>& more, const std::string& message,
                           int code = 1) {
    const auto out = train(stage, "refused", more);
    CHECK(out.code == code);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  refused("motion-to-text", {}, "[motionlang.config.102] --tokenizer is required", 2);
  refused("text-to-motion", {"--tokenizer", "tokenizer/model"}, "[motionlang.config.102] --describer is required", 2);
  refused("text-to-motion", {"--describer", "tokenizer/model"}, "not TM2T's transformer from motions to texts");
  const auto unmeasured = run({"evaluate", "alone/model", "--data", ".", "--captions", "captions.tsv"}, clips.path);
  CHECK(unmeasured.code == 1);
  CHECK_MESSAGE(contains(unmeasured.text, "[motionlang.config.102] alone/model: TM2T's motions of texts are judged by"),
                unmeasured.text);
  refused("tokenizer", {"--set", "tokenizer.window=96"}, "no motion to train on has more than tokenizer.window = 96");
  refused("tokenizer", {"--set", "tokenizer.window=30"}, "window is 30, expected a multiple of 4");
  refused("tokenizer", {"--set", "features=rifke"}, "features 'rifke' is not guoh3d or kit");
  CHECK(run({"train-tm2t", "--data", "."}, clips.path).code == 2);
  const auto published = run({"train-tm2t", "--stage", "tokenizer", "--print-config"}, clips.path);
  for (const char* text :
       {"\"codes\": 1024", "\"feature_bias\": 5", "\"adversarial_from\": 10", "\"batch\": 128", "\"lr\": 0.0001"})
    CHECK_MESSAGE(contains(published.text, text), published.text);
}
