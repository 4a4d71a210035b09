// The commands that train TMR, TEMOS, ACTOR and classifiers, and evaluate: on a few made-up clips, in seconds.
#include <doctest/doctest.h>

#include <array>
#include <map>
#include <numeric>
#include <sstream>

#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/kinematics/root_motion.hpp>
#include <motionlang/metrics/ape_ave.hpp>
#include <motionlang/weights/model_folder.hpp>

#include "../../examples/motionlang/train/text_motion_model.hpp"
#include "../support/body_arrays.hpp"
#include "../support/denoised.hpp"
#include "../support/glove_files.hpp"
#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Eight short walks of two kinds, with captions and labels.
struct Clips : TemporaryFolder {
  Clips() {
    std::string captions = "# clip\tstart\tend\tparts\tcaptions\n", labels = "# clip\tstart\tend\tlabel\n";
    for (int i = 0; i < 8; ++i) {
      const bool turns = i % 2 == 1;
      const std::string name = "clip" + std::to_string(i);
      ml::write_bvh(*this / (name + ".bvh"), synthetic::walk({.frames = 40 + 2 * i, .turn = turns ? 0.8 : 0.0}));
      captions += name + "\t0\t2\tlegs\t" +
                  (turns ? "a person turns left | someone turns\n" : "a person walks ahead | someone walks\n");
      labels += name + "\t0\t2\t" + (turns ? "turn" : "walk") + "\n";
    }
    ml::write_file(*this / "captions.tsv", captions);
    ml::write_file(*this / "labels.tsv", labels);
  }

  /// Small networks, an eighth of the clips to validate with and a quarter for tests.
  Outcome train(const std::string& command, const std::string& out, std::vector<std::string> more = {},
                const std::string& interrupt_at = "") const {
    const bool texts = command == "train-tmr" || command == "train-temos";
    std::vector<std::string> arguments{command,
                                       "--data",
                                       ".",
                                       "--out",
                                       out,
                                       "--preset",
                                       "small",
                                       texts ? "--captions" : "--labels",
                                       texts ? "captions.tsv" : "labels.tsv"};
    auto set = [&](const std::string& assignment) { arguments.insert(arguments.end(), {"--set", assignment}); };
    for (const char* a :
         {"data.min_seconds=0.5", "data.test_share=0.25", "data.validation_share=0.25", "optimiser.batch=2",
          "optimiser.schedule=constant", "optimiser.epochs=4", "optimiser.lr=0.01"})
      set(a);
    if (command != "train-classifier") {
      for (const char* a : {"network.latent_dim=8", "network.ff_size=8", "network.num_layers=1", "network.num_heads=2"})
        set(a);
    } else {
      set("hidden_size=8");
    }
    if (texts) {
      for (const char* a : {"data.mirror=false", "text.width=8", "text.vocabulary=40"}) set(a);
    } else {
      set("clips.num_frames=12");
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, path, interrupt_at);
  }
  ml::SafetensorsFile checkpoint(const std::string& out) const {
    return ml::SafetensorsFile::open(*this / (out + "/checkpoint.safetensors"));
  }
  std::vector<float> losses(const std::string& out) const {
    return ml::values_of<float>(checkpoint(out).tensor("losses"));
  }
  /// The names of the terms of the loss, and their values, (steps, terms).
  std::vector<std::string> terms(const std::string& out) const {
    std::istringstream lines(checkpoint(out).metadata().at("training.terms"));
    std::vector<std::string> names;
    for (std::string line; std::getline(lines, line);) names.push_back(line);
    return names;
  }
  std::vector<float> term_values(const std::string& out) const {
    return ml::values_of<float>(checkpoint(out).tensor("loss_terms"));
  }
  std::string weights(const std::string& out) const {
    return ml::read_file(*this / (out + "/model/weights.safetensors"));
  }
};

/// Two epochs of a tiny network, into "out".
Outcome train_tiny(const std::string& command, const std::filesystem::path& folder,
                   const std::vector<std::string>& more) {
  std::vector<std::string> arguments{command, "--preset", "small", "--out", "out", "--fresh"};
  for (const char* a : {"optimiser.epochs=2", "optimiser.batch=2", "network.latent_dim=8", "network.ff_size=8",
                        "network.num_layers=1", "network.num_heads=2", "text.width=8"})
    arguments.insert(arguments.end(), {"--set", a});
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run(arguments, folder);
}

/// A walk of so many rows, and what is said about it, in a data set.
void add_walk(const std::string& data_set, const std::string& id, int rows, const std::string& features,
              const ml::HumanMl3dForm& form, synthetic::Walk walk = {}) {
  const auto& f = ml::motion_features(features);
  walk.frames = rows + 1, walk.fps = f.fps;
  const auto values = f.from_motion(synthetic::walk(walk));
  const std::vector<float> joints(static_cast<std::size_t>(rows * 3 * form.joints));
  ml::HumanMl3dClip clip{id, rows, {values.begin(), values.end()}, joints, {}};
  clip.captions.push_back({.text = "a person walks " + id, .words = {}, .start = 0, .end = 0});
  ml::write_humanml3d_clip(data_set, clip, form);
}

double mean(std::span<const float> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

/// A tiny DistilBERT as Hugging Face has them, which knows the words of these captions.
ml::DistilBert<ml::EigenBackend<float>> write_distilbert(const std::filesystem::path& folder) {
  ml::Philox rng{.seed = 7};
  const ml::BertConfig tiny{.vocabulary = 12, .width = 8, .heads = 2, .d_ff = 12, .layers = 2, .positions = 16};
  const ml::DistilBert<ml::EigenBackend<float>> network(tiny, rng);
  ml::TensorStore store;
  store.add_module(network, "distilbert.");
  std::filesystem::create_directories(folder);
  ml::write_safetensors(folder / "model.safetensors", store.views());
  ml::write_file(folder / "config.json",
                 std::string_view(R"({"model_type": "distilbert", "dim": 8, "n_heads": 2, "n_layers": 2,
    "hidden_dim": 12, "vocab_size": 12, "max_position_embeddings": 16, "activation": "gelu"})"));
  ml::write_file(
      folder / "vocab.txt",
      std::string_view("[PAD]\n[UNK]\n[CLS]\n[SEP]\n[MASK]\na\nperson\nsomeone\nwalks\nturns\nahead\nleft\n"));
  return network;
}

}  // namespace

TEST_CASE(
    "each training lowers its loss, leaves a model, a checkpoint and curves; two halves, one recomputed, make the same "
    "weights") {
  const Clips clips;
  for (const std::string command : {"train-tmr", "train-temos", "train-actor", "train-classifier"}) {
    CAPTURE(command);
    const std::string whole = command + "_whole", halves = command + "_halves";
    const auto done = clips.train(command, whole, {"--set", "optimiser.epochs=50"});
    REQUIRE_MESSAGE(done.code == 0, done.text);
    CHECK(contains(done.text, "4 motions to train on, 2 for validation, 2 for tests"));
    CHECK_MESSAGE(contains(done.text, "trained  100 steps in 0:"), done.text);
    const auto losses = clips.losses(whole);
    REQUIRE(losses.size() == 100);
    CHECK(mean(std::span(losses).last(10)) < 0.9 * mean(std::span(losses).first(10)));
    const std::string curves = ml::read_file(clips / (whole + "/loss.svg"));
    CHECK(contains(curves, "validation"));
    const std::vector<std::string> terms = clips.terms(whole);
    CHECK(terms ==
          std::map<std::string, std::vector<std::string>>{
              {"train-tmr", {"recons", "kl", "latent", "contrastive"}},
              {"train-temos",
               {"recons_jfeats2jfeats", "recons_text2jfeats", "kl_text2motion", "kl_motion2text", "kl_text",
                "kl_motion", "latent_manifold"}},
              {"train-actor", {"rc", "rcxyz", "kl"}},
              {"train-classifier", {"cross entropy"}}}
              .at(command));
    CHECK(contains(curves, "terms of the training loss") == (terms.size() > 1));
    const auto values = clips.term_values(whole);
    REQUIRE(values.size() == 100 * terms.size());
    for (std::size_t step = 0; step < losses.size(); ++step) {  // they are what the loss is made of
      double sum = 0;
      for (std::size_t k = 0; k < terms.size(); ++k) sum += static_cast<double>(values[step * terms.size() + k]);
      CHECK(sum == doctest::Approx(losses[step]).epsilon(1e-5));
    }
    for (std::size_t k = 0; k < terms.size() && terms.size() > 1; ++k)  // the legend
      CHECK_MESSAGE(contains(curves, ">" + terms[k] + " "), terms[k]);
    CHECK(run({"info", whole + "/model/weights.safetensors"}, clips.path).code == 0);

    REQUIRE(clips.train(command, halves, {"--set", "optimiser.epochs=24"}).code == 0);
    const auto rest = clips.train(command, halves, {"--set", "optimiser.epochs=50", "--recompute"});
    REQUIRE_MESSAGE(rest.code == 0, rest.text);
    CHECK(contains(rest.text, "going on at step 48 of 100"));
    CHECK_MESSAGE(contains(rest.text, "trained  52 steps in 0:"), rest.text);
    const auto shorter = clips.train(command, halves, {"--set", "optimiser.epochs=24"});
    CHECK(shorter.code == 1);
    CHECK(contains(shorter.text, "checkpoint.safetensors has 100 steps, 48 are asked for"));
    CHECK(clips.losses(halves) == losses);
    CHECK(clips.term_values(halves) == values);
    CHECK(clips.weights(halves) == clips.weights(whole));
  }
  auto evaluate = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(), {"evaluate", name + "_whole/model", "--data", "."});
    return run(more, clips.path);
  };
  const auto tmr = evaluate("train-tmr", {"--captions", "captions.tsv"});
  CHECK_MESSAGE(tmr.code == 0, tmr.text);
  for (const char* word : {"text to motion", "all, texts alike", "by chance", "dissimilar"})
    CHECK_MESSAGE(contains(tmr.text, word), tmr.text);
  CHECK(!contains(tmr.text, "generated"));
  ml::write_file(clips / "dissimilar.txt", "elsewhere\n");
  const auto none_of_list = evaluate("train-tmr", {"--captions", "captions.tsv", "--nsim", "dissimilar.txt"});
  CHECK(none_of_list.code == 1);
  CHECK_MESSAGE(contains(none_of_list.text, "--nsim dissimilar.txt names no motion of the test part"),
                none_of_list.text);
  CHECK(!contains(none_of_list.text, "text to motion"));
  const auto row = [](const std::string& text, const std::string& name) {  // the last one that begins so
    const auto at = text.rfind("  " + name);
    return at == text.npos ? name + " is missing in\n" + text : text.substr(at, text.find('\n', at) - at);
  };
  const auto synthesis = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"--captions", "captions.tsv", "--part", "training", "--synthesis"});
    const auto out = evaluate("train-tmr", more);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    CHECK_MESSAGE(!contains(row(out.text, "generated "), "is missing"), out.text);
    return out.text;
  };
  const auto by_itself = synthesis({});
  CHECK(row(synthesis({}), "generated ") == row(by_itself, "generated "));
  const auto by_temos = synthesis({"--generator", "train-temos_whole/model"});
  CHECK(row(by_temos, "dissimilar ") == row(by_itself, "dissimilar "));  // of recorded motions
  CHECK(evaluate("train-tmr", {"--captions", "captions.tsv", "--generator", "train-temos_whole/model"}).code != 0);
  const auto temos = evaluate("train-temos", {"--captions", "captions.tsv", "--samples", "2", "--strips", "strips"});
  CHECK_MESSAGE(temos.code == 0, temos.text);
  for (const char* word : {"APE", "best of 2 samples", "worst of 2 samples", "mean pose", "random clip"})
    CHECK_MESSAGE(contains(temos.text, word), temos.text);
  CHECK(std::filesystem::exists(clips / "strips/1.svg"));
  const auto no_folder = evaluate("train-temos", {"--captions", "captions.tsv", "--strips", "captions.tsv"});
  CHECK(no_folder.code == 1);
  CHECK_MESSAGE(contains(no_folder.text, "[motionlang.io.401] --strips captions.tsv: "), no_folder.text);
  const auto actor = evaluate("train-actor", {"--labels", "labels.tsv", "--classifier", "train-classifier_whole/model",
                                              "--seeds", "2", "--part", "training"});
  CHECK_MESSAGE(actor.code == 0, actor.text);
  for (const char* word : {"accuracy", "FID", "recorded", "generated", "  denoised  ", "  between two of an action "})
    CHECK_MESSAGE(contains(actor.text, word), actor.text);
  std::string walks;  // a part without one of the classes
  for (int i = 0; i < 8; i += 2) walks += "clip" + std::to_string(i) + "\t0\t2\twalk\n";
  ml::write_file(clips / "walks.tsv", walks);
  const auto one_class = evaluate(
      "train-actor",
      {"--labels", "walks.tsv", "--classifier", "train-classifier_whole/model", "--seeds", "2", "--part", "training"});
  CHECK_MESSAGE(one_class.code == 0, one_class.text);
  CHECK_MESSAGE(contains(one_class.text, "  generated"), one_class.text);
  const auto classifier = evaluate("train-classifier", {"--labels", "labels.tsv", "--seeds", "2", "--part", "training",
                                                        "--threads", "1", "--precision", "bf16"});
  CHECK_MESSAGE(classifier.code == 0, classifier.text);
  CHECK_MESSAGE(contains(classifier.text, "accuracy"), classifier.text);

  const auto moments = evaluate("train-tmr", {"--captions", "captions.tsv", "--part", "training", "--moments", "3",
                                              "--joined", "2", "--windows", "0.5,1.5", "--stride", "0.5"});
  CHECK_MESSAGE(moments.code == 0, moments.text);
  for (const char* word :
       {"6 texts in 3 motions of 2 clips of the training part", "0.5 s", "1.5 s", "all lengths", "a random window"})
    CHECK_MESSAGE(contains(moments.text, word), moments.text);
  CHECK(evaluate("train-tmr", {"--captions", "captions.tsv", "--moments", "3", "--windows", "99"}).code == 2);
  CHECK(evaluate("train-tmr", {"--captions", "captions.tsv", "--moments", "3", "--stride", "0"}).code == 2);

  // what was trained makes motions
  const auto generate = [&](const std::string& name, std::vector<std::string> more) {
    more.insert(more.begin(), {"generate", "--model", name + "_whole/model"});
    return run(more, clips.path);
  };
  for (const std::string name : {"train-temos", "train-tmr"}) {
    const auto made = generate(name, {"--text", "a person turns left", "--seconds", "1", "--out", name + "_made"});
    REQUIRE_MESSAGE(made.code == 0, made.text);
    CHECK(std::filesystem::exists(clips / (name + "_made/a_person_turns_left.html")));
    const auto motion = ml::read_bvh_motion(clips / (name + "_made/a_person_turns_left.bvh"));
    CHECK(motion.seconds() == doctest::Approx(1).epsilon(0.1));
    CHECK(motion.skeleton.size() == 24);
    const auto steps = generate(name, {"--text", "a person turns left", "--steps", "5"});
    CHECK(steps.code == 2);
    CHECK_MESSAGE(contains(steps.text, "--steps, --sampler, --preset and --guidance are for diffusion models"),
                  steps.text);
  }
  REQUIRE(generate("train-actor", {"--action", "walk", "--seconds", "0.8", "--out", "made"}).code == 0);
  REQUIRE(generate("train-actor", {"--action", "1", "--seconds", "0.8", "--out", "made"}).code == 0);
  CHECK(ml::read_bvh_motion(clips / "made/walk.bvh").frames() == 12);
  CHECK(ml::read_file(clips / "made/1.bvh") == ml::read_file(clips / "made/walk.bvh"));
  CHECK(contains(generate("train-actor", {"--action", "fly"}).text,
                 "action 'fly' is not one of 0 ... 1; they are called turn, walk"));

  // towards another text or action, and a recorded motion as the model knows it
  for (const std::string name : {"train-temos", "train-tmr", "train-actor"}) {
    CAPTURE(name);
    const bool acts = name == "train-actor";
    const std::string kind = acts ? "--action" : "--text", walk = acts ? "walk" : "a person walks ahead",
                      turn = acts ? "turn" : "a person turns left",
                      line = acts ? "walk_to_turn" : "a_person_walks_ahead_to_a_person_turns_left";
    const auto made =
        generate(name, {kind, walk, "--towards", turn, "--samples", "3", "--seconds", "0.8", "--out", "line"});
    REQUIRE_MESSAGE(made.code == 0, made.text);
    for (const char* end : {"_1.bvh", "_2.svg", "_3.npz", ".html"})
      CHECK_MESSAGE(std::filesystem::exists(clips / ("line/" + line + end)), end);
    CHECK(ml::read_file(clips / ("line/" + line + "_1.bvh")) != ml::read_file(clips / ("line/" + line + "_2.bvh")));

    std::vector<std::string> convert{"convert", "clip1.bvh", name + ".bvh", "--denoise", name + "_whole/model"};
    if (acts) convert.insert(convert.end(), {"--action", "turn"});
    const auto cleaned = run(convert, clips.path);
    REQUIRE_MESSAGE(cleaned.code == 0, cleaned.text);
    const auto before = ml::read_bvh_motion(clips / "clip1.bvh"), after = ml::read_bvh_motion(clips / (name + ".bvh"));
    CHECK(after.fps == doctest::Approx(before.fps));
    CHECK(after.seconds() == doctest::Approx(before.seconds()).epsilon(0.1));
  }

  const auto info = [&](const std::string& name) { return run({"info", name + "_whole/model"}, clips.path).text; };
  for (const char* line :
       {"model of                 actor", "actions                  turn, walk", "latent_dim 8", "pose rot6d"})
    CHECK_MESSAGE(contains(info("train-actor"), line), line);
  for (const char* line : {"model of                 tmr", "temperature 0.1", "guoh3d, 20 frames per second"})
    CHECK_MESSAGE(contains(info("train-tmr"), line), line);

  // sizes that the file of weights has no room for
  const auto enlarge = [&](const std::string& name, const nlohmann::json& sizes) {
    const auto path = clips / (name + "_whole/model/config.json");
    auto config = nlohmann::json::parse(ml::read_file(path));
    config["config"].merge_patch(sizes);
    ml::write_file(path, std::string_view(config.dump()));
  };
  const auto refused = [](const Outcome& out) {
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, "[motionlang.config.102] "), out.text);
    CHECK_MESSAGE(contains(out.text, "65536"), out.text);
  };
  for (const std::string name : {"train-temos", "train-tmr", "train-actor"}) {
    enlarge(name, {{"network", {{"latent_dim", 65536}}}});
    refused(generate(name, {name == "train-actor" ? "--action" : "--text", "walk", "--seconds", "0.8"}));
  }
  enlarge("train-classifier", {{"hidden_size", 65536}});
  refused(evaluate("train-classifier", {"--labels", "labels.tsv"}));
}

TEST_CASE("clips that only their extensions tell apart do not get each other's captions and labels") {
  const Clips clips;
  ml::write_amass(clips / "clip0.npz", synthetic::walk({.frames = 44, .turn = 0.8}));
  const auto doubt = [&](const Outcome& out, const std::string& place) {
    CHECK(out.code == 1);
    CHECK_MESSAGE(
        contains(out.text, "[motionlang.io.403] " + place +
                               ": 'clip0' may be clip0.bvh or clip0.npz: a name with its extension says which"),
        out.text);
  };
  doubt(clips.train("train-tmr", "x"), "captions.tsv:2");
  doubt(clips.train("train-actor", "x"), "labels.tsv:2");
  ml::write_file(clips / "annotations.json", std::string_view(R"({"00": {"path": "clip0", "duration": 2.0,
    "annotations": [{"seg_id": "0", "text": "walk", "start": 0.0, "end": 2.0, "act_cat": ["walk"]}]}})"));
  for (const std::string command : {"train-tmr", "train-actor"}) {
    const Outcome out = run({command, "--data", ".", "--annotations", "annotations.json", "--out", "x", "--preset",
                             "small", "--set", "data.test_share=0", "--set", "data.validation_share=0"},
                            clips.path);
    CHECK_MESSAGE((out.code == 1 && contains(out.text, "'clip0' may be clip0.bvh or clip0.npz")), out.text);
  }
  std::string captions = ml::read_file(clips / "captions.tsv");
  captions.insert(captions.find("clip0") + 5, ".bvh");
  ml::write_file(clips / "captions.tsv", captions + "clip0.npz\t0\t2\tlegs\ta person turns left\n");
  std::filesystem::create_directories(clips / "lists");
  ml::write_file(clips / "lists/test.txt", std::string_view("clip0\nclip1\n"));  // both of that name
  ml::write_file(clips / "lists/train.txt", std::string_view("clip2\nclip3\nclip4\n"));
  ml::write_file(clips / "lists/val.txt", std::string_view("clip5\n"));
  const Outcome out = clips.train("train-tmr", "x", {"--splits", "lists"});
  CHECK_MESSAGE((out.code == 0 && contains(out.text, "3 motions to train on, 1 for validation, 3 for tests")),
                out.text);
}

TEST_CASE(
    "a learned temperature, ST-GCN, vertices of a body, going on from a model, motions of a model to learn from") {
  const Clips clips;
  const auto trained = [&](const std::string& command, const std::string& out, std::vector<std::string> more) {
    const auto done = clips.train(command, out, std::move(more));
    REQUIRE_MESSAGE(done.code == 0, done.text);
  };
  // few texts, all alike
  trained("train-tmr", "warm", {"--set", "losses.learned_temperature=true", "--set", "losses.threshold=0"});
  const auto weights = ml::SafetensorsFile::open(clips / "warm/model/weights.safetensors");
  CHECK(ml::values_of<double>(weights.tensor("log_temperature")).front() !=
        doctest::Approx(std::log(0.1)).epsilon(1e-4));
  CHECK(run({"evaluate", "warm/model", "--data", ".", "--captions", "captions.tsv"}, clips.path).code == 0);
  const std::string whole = ml::read_file(clips / "warm/model/config.json");
  std::string wrong = whole;
  wrong.replace(wrong.find("\"num_layers\": "), 14, "\"num_layers\": -");
  ml::write_file(clips / "warm/model/config.json", wrong);
  const auto named = run({"evaluate", "warm/model", "--data", ".", "--captions", "captions.tsv"}, clips.path);
  CHECK_MESSAGE(
      contains(named.text, "[motionlang.config.101] warm/model/config.json: config: network: num_layers is -"),
      named.text);
  ml::write_file(clips / "warm/model/config.json", whole);
  const auto cold = clips.train(
      "train-tmr", "cold", {"--set", "losses.learned_temperature=true", "--set", "losses.contrastive_loss=margin"});
  CHECK(contains(cold.text, "losses.learned_temperature is for info_nce"));

  for (const auto& [set, expected] : {std::pair("optimiser.lr=-1", "lr is -1, expected 0 or more"),
                                      {"optimiser.epochs=0", "epochs is 0, expected 1 or more"},
                                      {"losses.kl=-1", "kl is -1, expected 0 or more"},
                                      {"network.num_layers=1000000", "num_layers is 1000000, expected 1 to 256"},
                                      {"data.test_share=2", "test_share is 2, expected 0 or more, and less than 1"}}) {
    const auto refused = clips.train("train-tmr", "refused", {"--set", set});
    CHECK(refused.code == 1);
    CHECK_MESSAGE(contains(refused.text, expected), refused.text);
  }

  trained("train-classifier", "graph", {"--set", "kind=stgcn", "--set", "clips.translation=false", "--set", "width=4"});
  CHECK(run({"evaluate", "graph/model", "--data", ".", "--labels", "labels.tsv", "--seeds", "2"}, clips.path).code ==
        0);

  std::vector<std::string> weights_of_0{"--set", "losses.rc=0", "--set", "losses.rcxyz=0", "--set", "losses.kl=0"};
  const auto idle = clips.train("train-actor", "idle", weights_of_0);
  CHECK(idle.code == 1);
  CHECK_MESSAGE(contains(idle.text, "losses.rc, rcxyz, kl, vel and velxyz are 0, expected one above 0"), idle.text);
  weights_of_0.insert(weights_of_0.end(), {"--set", "losses.vel=1"});
  trained("train-actor", "speeds", weights_of_0);

  trained("train-actor", "first", {});
  trained("train-actor", "second",
          {"--from", "first/model", "--set", "clips.num_frames=-2", "--set", "clips.min_len=10", "--set",
           "clips.max_len=14", "--set", "optimiser.lr=0"});
  // nothing is learnt at rate 0, so it is what was gone on from
  CHECK(clips.weights("second") == clips.weights("first"));
  CHECK(run({"evaluate", "first/model", "--data", ".", "--labels", "labels.tsv", "--classifier", "graph/model",
             "--seeds", "2"},
            clips.path)
            .code == 0);  // ST-GCN does not read the way of the root

  // fully connected networks have motions of one length: 12 frames, 15 a second
  trained("train-actor", "full",
          {"--set", "network.encoder=fully_connected", "--set", "network.decoder=fully_connected"});
  const auto walks_for = [&](const std::string& seconds) {
    return run({"generate", "--model", "full/model", "--action", "walk", "--seconds", seconds, "--out", "made"},
               clips.path);
  };
  const std::string one_length = "this ACTOR is fully connected, its motions have 12 frames (0.8 s)";
  CHECK(walks_for("0.8").code == 0);
  const auto longer = walks_for("2");
  CHECK(longer.code == 2);
  CHECK_MESSAGE(contains(longer.text, "[motionlang.config.101] a motion of 30 frames (2 s); " + one_length),
                longer.text);
  ml::write_bvh(clips / "brief.bvh", synthetic::walk({.frames = 10}));
  const auto brief =
      run({"convert", "brief.bvh", "out.bvh", "--denoise", "full/model", "--action", "walk"}, clips.path);
  CHECK(brief.code == 2);
  CHECK_MESSAGE(contains(brief.text, "[motionlang.config.101] a motion of "), brief.text);
  CHECK_MESSAGE(contains(brief.text, one_length), brief.text);

  // a model of another pose representation is judged by the same classifiers
  const auto recorded = [&](const std::string& model, const std::string& classifier) {
    const auto out = run({"evaluate", model + "/model", "--data", ".", "--labels", "labels.tsv", "--classifier",
                          classifier + "/model", "--seeds", "2", "--part", "training"},
                         clips.path);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return out.text.substr(out.text.find("  recorded"), out.text.find("  generated") - out.text.find("  recorded"));
  };
  trained("train-classifier", "gru", {});
  // a GRU whose state is drawn, in use as well
  trained("train-classifier", "drawn", {"--set", "drawn_state=true"});
  CHECK(clips.losses("drawn") != clips.losses("gru"));
  const std::string by_drawn = recorded("first", "drawn");
  CHECK(by_drawn == recorded("first", "drawn"));
  const auto preset = run({"train-classifier", "--preset", "gru-published", "--print-config"}, clips.path);
  for (const char* line : {R"("kind": "gru")", R"("hidden_size": 128)", R"("num_layers": 2)", R"("drawn_state": true)",
                           R"("num_frames": 60)", R"("lr": 0.0001)", R"("batch": 64)", R"("epochs": 100)"})
    CHECK_MESSAGE(contains(preset.text, line), preset.text);
  for (const std::string pose : {"rotvec", "rotquat", "rotmat", "xyz"}) {
    CAPTURE(pose);
    trained("train-actor", pose, {"--set", "clips.pose=" + pose});
    CHECK(recorded(pose, "gru") == recorded("first", "gru"));
    const auto by_graph = recorded(pose, "graph");
    if (pose != "xyz") CHECK(by_graph == recorded("first", "graph"));  // positions do not say how bones are twisted
  }
  trained("train-classifier", "points", {"--set", "clips.pose=xyz"});
  recorded("first", "points");

  ml::write_npz(clips / "body.npz", body_arrays::chain(24, 6, 10));
  trained("train-actor", "skin", {"--body", "body.npz", "--set", "losses.points=vertices"});
  CHECK(clips.losses("skin") != clips.losses("first"));
  trained("train-actor", "joints_of_skin", {"--body", "body.npz", "--set", "losses.points=smpl"});
  CHECK(clips.losses("joints_of_skin") != clips.losses("skin"));
  const auto no_points = [&](const std::string& points, std::vector<std::string> more, const std::string& message) {
    more.insert(more.end(), {"--set", "losses.points=" + points});
    const auto out = clips.train("train-actor", "bare", more);
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  ml::write_npy(clips / "extra.npy", ml::NpyArray::of(std::span<const float>(std::vector<float>(9 * 6)), {9, 6}));
  no_points("vertices", {}, "[motionlang.config.102] losses.points = vertices, and --body is ''");
  no_points("joints", {"--joint-regressor", "extra.npy"},
            "losses.points = joints has no use for --joint-regressor extra.npy");
  no_points("smpl", {"--body", "body.npz", "--joint-regressor", "extra.npy"},
            "'smpl' have no use for --joint-regressor extra.npy");
  no_points("a2m", {"--body", "body.npz"},
            "points 'a2m' need --joint-regressor, J_regressor_extra.npy of SPIN or VIBE");
  no_points("vibe", {"--body", "body.npz", "--joint-regressor", "extra.npy"},
            "body.npz: a body of 6 vertices; points 'vibe' are of SMPL's 6890");
  no_points("coco", {"--body", "body.npz"}, "[motionlang.config.103]");

  // points that have vertices of SMPL among them, and a regressor's
  ml::write_npz(clips / "smpl.npz", body_arrays::chain(24, 6890, 10));
  no_points("a2m", {"--body", "smpl.npz", "--joint-regressor", "extra.npy"},
            "[motionlang.io.407] extra.npy: an array (9, 6), expected (9, 6890)");
  const std::vector<float> shares(9 * 6890, 1.0f / 6890);
  ml::write_npy(clips / "extra.npy", ml::NpyArray::of(std::span<const float>(shares), {9, 6890}));
  std::vector<float> last;
  for (const std::string points : {"a2m", "a2mpl", "vibe"}) {
    CAPTURE(points);
    trained("train-actor", points,
            {"--body", "smpl.npz", "--joint-regressor", "extra.npy", "--set", "losses.points=" + points, "--set",
             "optimiser.epochs=1"});
    CHECK(clips.losses(points) != last);
    last = clips.losses(points);
  }

  // random frames
  trained("train-actor", "scattered", {"--set", "clips.random_frames=true"});
  CHECK(clips.losses("scattered") != clips.losses("first"));
  const auto steps =
      clips.train("train-actor", "no", {"--set", "clips.random_frames=true", "--set", "clips.random_step=true"});
  CHECK(steps.code == 1);
  CHECK_MESSAGE(
      contains(steps.text, "clips.random_frames has no steps; clips.random_step is true, clips.sampling_step 1"),
      steps.text);
  const auto other = clips.train("train-actor", "no", {"--from", "first/model", "--set", "clips.camera=true"});
  CHECK(other.code == 1);
  CHECK_MESSAGE(contains(other.text, "camera false; the settings say "), other.text);

  const auto learn = [&](const std::string& share, const std::string& out) {
    return clips.train("train-classifier", out, {"--generated", "first/model", "--set", "generated_share=" + share});
  };
  REQUIRE(learn("0.5", "half").code == 0);
  REQUIRE(learn("1", "all").code == 0);
  trained("train-classifier", "none", {});
  CHECK(clips.losses("half") != clips.losses("none"));
  CHECK(clips.losses("all") != clips.losses("half"));
  CHECK(contains(learn("0", "no").text, "one needs the other"));
  CHECK(contains(clips
                     .train("train-classifier", "no",
                            {"--generated", "first/model", "--set", "generated_share=0.5", "--set", "clips.fps=10"})
                     .text,
                 "model and classifier have other clips: fps 15, turned_ahead true, translation true, global true and "
                 "fps 10"));

  // going on with another set of terms: those of the steps since then
  trained("train-actor", "speeds",
          {"--set", "losses.rc=1", "--set", "losses.rcxyz=0", "--set", "losses.kl=0", "--set", "losses.vel=1", "--set",
           "optimiser.epochs=6", "--other-settings"});
  CHECK(clips.terms("speeds") == std::vector<std::string>{"rc", "vel"});
  CHECK(clips.losses("speeds").size() == 12);
  CHECK(clips.term_values("speeds").size() == 2 * 4);
}

TEST_CASE(
    "the rows of thesis table 4.3, each one setting; the same terms of TMR's loss, which weights of 0 switch off, "
    "too") {
  const Clips clips;
  const auto losses = [&](const std::string& command, std::vector<std::string> more) {
    more.insert(more.begin(), {"--fresh", "--set", "optimiser.epochs=1", "--set", "optimiser.lr=0", "--set",
                               "losses.kl=1", "--set", "losses.latent=1", "--set", "losses.threshold=0"});
    const auto done = clips.train(command, "row", more);
    REQUIRE_MESSAGE(done.code == 0, done.text);
    return clips.losses("row");
  };
  const auto row = [&](const std::string& command, const std::string& set) { return losses(command, {"--set", set}); };
  const auto whole = losses("train-temos", {});
  CHECK(row("train-temos", "network.motion_encoder=transformer") == whole);
  std::vector<std::vector<float>> rows{whole};
  for (const char* set :
       {R"(network={"motion_encoder": "gru", "motion_decoder": "gru"})", "network.motion_encoder=none",
        "losses.embedding=false", R"(losses={"cross_modal_kl": false, "embedding": false})",
        "losses.cross_modal_kl=false", "losses.gaussian_kl=false", "network.vae=false", "network.activation=relu"}) {
    CAPTURE(set);
    rows.push_back(row("train-temos", set));
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) CHECK(rows[i] != rows.back());
  }
  for (const std::string command : {"train-temos", "train-tmr"}) {
    CAPTURE(command);
    CHECK(row(command, "losses.embedding=false") == row(command, "losses.latent=0"));
    const auto both = row(command, R"(losses={"cross_modal_kl": false, "gaussian_kl": false})");
    CHECK(both == row(command, "losses.kl=0"));
    const auto all = losses(command, {});
    const auto across = row(command, "losses.gaussian_kl=false"), priors = row(command, "losses.cross_modal_kl=false");
    for (std::size_t i = 0; i < all.size(); ++i) {
      CHECK(across[i] > both[i]);
      CHECK(priors[i] > both[i]);
      CHECK(all[i] - both[i] == doctest::Approx(across[i] - both[i] + priors[i] - both[i]).epsilon(1e-4));
    }
  }
  const auto refused = clips.train("train-tmr", "row", {"--set", "network.activation=gelo"});
  CHECK(refused.code == 1);
  CHECK_MESSAGE(contains(refused.text, "activation 'gelo' is not one of none, relu, gelu"), refused.text);
}

TEST_CASE("an ACTOR without the rotation of joint 0; vertices that move; networks that know no time") {
  const Clips clips;
  const auto trained = [&](const std::string& command, const std::string& out, std::vector<std::string> more) {
    const auto done = clips.train(command, out, std::move(more));
    REQUIRE_MESSAGE(done.code == 0, done.text);
  };
  const std::vector<std::string> ahead{"--set", "clips.global=false"};
  trained("train-actor", "turning", {});
  trained("train-classifier", "turning_gru", {});
  for (const std::string pose : {"rot6d", "rotquat"}) {
    CAPTURE(pose);
    trained("train-actor", "ahead", {"--fresh", "--set", "clips.global=false", "--set", "clips.pose=" + pose});
    REQUIRE(
        run({"generate", "--model", "ahead/model", "--action", "turn", "--seconds", "0.8", "--out", "made"}, clips.path)
            .code == 0);
    const auto made = ml::read_bvh_motion(clips / "made/turn.bvh");
    for (ml::Index f = 0; f < made.frames(); ++f) CHECK(std::abs(made.rotations(f)[0].w) > 1 - 1e-6);
    CHECK(run({"convert", "clip1.bvh", "clean.bvh", "--denoise", "ahead/model", "--action", "turn"}, clips.path).code ==
          0);
  }
  trained("train-classifier", "ahead_gru", ahead);
  trained(
      "train-classifier", "ahead_graph",
      {"--set", "clips.global=false", "--set", "kind=stgcn", "--set", "clips.translation=false", "--set", "width=4"});
  const auto judged = [&](const std::string& model, const std::string& classifier) {
    return run({"evaluate", model + "/model", "--data", ".", "--labels", "labels.tsv", "--classifier",
                classifier + "/model", "--seeds", "2", "--part", "training"},
               clips.path);
  };
  for (const std::string classifier : {"ahead_gru", "ahead_graph"}) {
    const auto by_ahead = judged("ahead", classifier), by_turning = judged("turning", classifier);
    REQUIRE_MESSAGE(by_ahead.code == 0, by_ahead.text);
    REQUIRE_MESSAGE(by_turning.code == 0, by_turning.text);
    const auto recorded = [](const std::string& text) {
      return text.substr(text.find("  recorded"), text.find("  generated") - text.find("  recorded"));
    };
    CHECK(recorded(by_ahead.text) == recorded(by_turning.text));
  }
  const auto refused = judged("ahead", "turning_gru");
  CHECK(refused.code == 1);
  CHECK_MESSAGE(contains(refused.text,
                         "translation true, global false and fps 15, turned_ahead true, translation true, global true"),
                refused.text);

  ml::write_npz(clips / "body.npz", body_arrays::chain(24, 6, 10));
  const std::vector<std::string> skin{"--body", "body.npz",          "--set", "losses.points=vertices",
                                      "--set",  "clips.global=false"};
  trained("train-actor", "skin", skin);
  auto moved = skin;
  moved.insert(moved.end(), {"--set", "losses.vertstrans=true"});
  trained("train-actor", "moved", moved);
  CHECK(mean(clips.losses("moved")) > mean(clips.losses("skin")));
  CHECK(contains(clips.train("train-actor", "no", {"--set", "losses.vertstrans=true"}).text,
                 "losses.vertstrans is of points of a body"));

  const std::vector<std::string> gru{"--set", "network.encoder=gru", "--set", "network.decoder=gru"};
  trained("train-actor", "time", gru);
  auto timeless = gru;
  timeless.insert(timeless.end(), {"--set", "network.concatenate_time=false"});
  trained("train-actor", "timeless", timeless);
  CHECK(clips.weights("timeless").size() < clips.weights("time").size());  // a column less
  CHECK(run({"generate", "--model", "timeless/model", "--action", "walk", "--seconds", "0.8"}, clips.path).code == 0);
}

TEST_CASE(
    "a classifier learns from motions that a model samples, denoises or puts between two; validation motions are "
    "recorded") {
  const Clips clips;
  for (int i = 0; i < 8; ++i)  // no two alike
    ml::write_bvh(clips / ("clip" + std::to_string(i) + ".bvh"),
                  synthetic::walk({.frames = 40, .steps_per_second = 1 + 0.3 * i, .turn = i % 2 == 1 ? 0.8 : 0.0}));
  // nothing is learnt at rate 0, and whole clips are not drawn: from epoch to epoch only what the model draws changes
  const auto train = [&](const std::string& out, std::vector<std::string> more) {
    more.insert(more.begin(), {"--set", "optimiser.lr=0", "--set", "clips.num_frames=-1"});
    return clips.train("train-classifier", out, more);
  };
  const auto learn = [&](const std::string& out, const std::string& kind, const std::string& share = "1",
                         const std::string& model = "rot6d") {
    return train(
        out, {"--generated", model + "/model", "--set", "generated_share=" + share, "--set", "generated_kind=" + kind});
  };
  for (const std::string pose : {"rot6d", "rotvec"})  // models whose latents tell motions apart
    REQUIRE(clips
                .train("train-actor", pose,
                       {"--set", "clips.pose=" + pose, "--set", "losses.kl=0", "--set", "optimiser.epochs=40", "--set",
                        "clips.num_frames=-1"})
                .code == 0);
  REQUIRE(train("recorded", {}).code == 0);
  for (const std::string kind : {"sampled", "denoised", "interpolated"}) {
    const auto done = learn(kind, kind);
    REQUIRE_MESSAGE(done.code == 0, done.text);
  }
  const auto epoch = [&](const std::string& out, std::size_t e) {  // mean loss, of two steps
    return mean(std::span<const float>(clips.losses(out)).subspan(2 * e, 2));
  };
  const auto validations = [&](const std::string& out) {
    return ml::values_of<double>(
        ml::SafetensorsFile::open(clips / (out + "/checkpoint.safetensors")).tensor("validations"));
  };
  for (const std::string kind : {"recorded", "sampled", "denoised", "interpolated"}) {
    CAPTURE(kind);
    const bool drawn = kind == "sampled" || kind == "interpolated";
    CHECK_MESSAGE((std::abs(epoch(kind, 0) - epoch(kind, 1)) > 2e-6) == drawn, epoch(kind, 0)
                                                                                   << ", " << epoch(kind, 1));
    CHECK(validations(kind) == validations("recorded"));
    if (kind != "recorded") CHECK(std::abs(epoch(kind, 0) - epoch("recorded", 0)) > 1e-4);
  }
  REQUIRE(learn("again", "interpolated").code == 0);
  CHECK(clips.losses("again") == clips.losses("interpolated"));
  REQUIRE(learn("half", "denoised", "0.5").code == 0);
  CHECK(std::abs(epoch("half", 0) - epoch("half", 1)) > 2e-6);  // which are denoised is drawn

  // an ACTOR of another pose representation is given the motions in its own
  const auto other = learn("other", "denoised", "1", "rotvec");
  REQUIRE_MESSAGE(other.code == 0, other.text);
  CHECK(std::abs(epoch("other", 0) - epoch("other", 1)) < 2e-6);
  CHECK(validations("other") == validations("recorded"));

  CHECK(contains(learn("no", "noisy").text,
                 "[motionlang.config.103] generated_kind 'noisy' is not sampled, denoised or interpolated"));
}

TEST_CASE("text.finetune trains DistilBERT with TMR and TEMOS; its weights and tokenizer are the model's own") {
  const Clips clips;
  const auto network = write_distilbert(clips / "bert");
  const auto train = [&](const std::string& command, const std::string& out, std::vector<std::string> more) {
    more.insert(more.begin(),
                {"--set", "text.encoder=distilbert", "--text-encoder", "bert", "--set", "losses.threshold=0"});
    return clips.train(command, out, more);
  };
  const std::string key = "textencoder.text_model.transformer.layer.1.attention.q_lin.weight";
  for (const std::string command : {"train-tmr", "train-temos"}) {
    CAPTURE(command);
    const std::string frozen = command + "_frozen", whole = command + "_whole", halves = command + "_halves",
                      model = whole + "/model";
    REQUIRE(train(command, frozen, {}).code == 0);
    CHECK(!contains(clips.weights(frozen), "text_model"));
    const auto done = train(command, whole, {"--set", "text.finetune=true"});
    REQUIRE_MESSAGE(done.code == 0, done.text);
    CHECK(clips.losses(whole) != clips.losses(frozen));
    const auto weights = ml::SafetensorsFile::open(clips / (model + "/weights.safetensors"));
    CHECK(ml::values_of<float>(weights.tensor(key)) != network.layers[1].query.weight.to_vector());
    CHECK(ml::values_of<float>(weights.tensor("textencoder.text_model.embeddings.word_embeddings.weight")) !=
          network.words.weight.to_vector());

    REQUIRE(train(command, halves, {"--set", "text.finetune=true", "--set", "optimiser.epochs=2"}).code == 0);
    const auto rest = train(command, halves, {"--set", "text.finetune=true"});
    REQUIRE_MESSAGE(rest.code == 0, rest.text);
    CHECK(contains(rest.text, "going on at step 4 of 8"));
    CHECK(clips.losses(halves) == clips.losses(whole));
    CHECK(clips.weights(halves) == clips.weights(whole));

    // it needs no --text-encoder, and what it says is what its own DistilBERT makes of a text
    std::filesystem::rename(clips / "bert", clips / "elsewhere");
    const auto used = [&](std::vector<std::string> arguments) {
      const auto out = run(arguments, clips.path);
      CHECK_MESSAGE(out.code == 0, out.text);
      return out.text;
    };
    used({"generate", "--model", model, "--text", "a person turns left", "--seconds", "1", "--out", command + "_made"});
    used({"evaluate", model, "--data", ".", "--captions", "captions.tsv"});
    if (command == "train-tmr") {
      used({"index", ".", "--model", model, "-o", "moves.index"});
      CHECK(contains(used({"search", "moves.index", "a person turns left"}), ".bvh"));
      used({"evaluate", model, "--data", ".", "--captions", "captions.tsv", "--moments", "2", "--joined", "2", "--part",
            "training"});
      const auto read = program::load_text_motion<ml::Tmr, ml::EigenBackend<float>>(
          clips / model, program::read_text_motion_config(clips / model));
      const std::vector<std::string> text{"someone walks"};
      auto trained = network;
      ml::load_module(trained, weights, "textencoder.text_model.");
      const std::vector<ml::Index> ids{2, 7, 8, 3};
      CHECK(read.tokens(text, nullptr).rows.to_vector() == trained({ids, {4}}).tokens.rows.to_vector());
    }
    std::filesystem::rename(clips / "elsewhere", clips / "bert");
  }

  const auto refused = [&](const std::string& set, const std::string& encoder, const std::string& message) {
    std::vector<std::string> more{"--set", "text.finetune=true", "--set", set};
    if (!encoder.empty()) more.insert(more.end(), {"--text-encoder", encoder});
    const auto out = clips.train("train-tmr", "refused", more);
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  ml::EmbeddingCache cache(8);
  cache.add("a person walks ahead", std::vector<float>(16));
  cache.write(clips / "states", "bert");
  refused("text.encoder=distilbert", "states/bert.npy",
          "--text-encoder 'states/bert.npy', expected distilbert and its folder");
  refused("text.encoder=word_pieces", "",
          "[motionlang.config.102] text.finetune trains DistilBERT: text.encoder is 'word_pieces'");
  std::filesystem::create_directories(clips / "strangers");
  ml::write_file(clips / "strangers/config.json", std::string_view(R"({"model_type": "bert"})"));
  refused("text.encoder=distilbert", "strangers",
          "[motionlang.config.103] strangers/config.json: model_type 'bert', expected 'distilbert'");
}

TEST_CASE("Ctrl-C keeps a checkpoint, from which the same command goes on; early stop") {
  const Clips clips;
  const auto stopped = clips.train("train-tmr", "run", {"--set", "optimiser.epochs=20000"}, "training [");
  CHECK_MESSAGE(stopped.code == 130, stopped.text);
  CHECK(contains(stopped.text, "the same command goes on from run/checkpoint.safetensors"));
  CHECK(!std::filesystem::exists(clips / "run/model"));
  const auto steps = clips.losses("run").size();
  CHECK(steps > 0);
  const auto other = clips.train("train-tmr", "run", {"--set", "optimiser.lr=0.1"});
  CHECK(other.code == 1);
  CHECK_MESSAGE(contains(other.text, "this run began with another training.optimiser.lr (0.01, not 0.1)"), other.text);
  // nothing is learnt: two validations that are not better than the first end it
  const auto early =
      clips.train("train-classifier", "early",
                  {"--set", "optimiser.lr=0", "--set", "validation.patience=2", "--set", "optimiser.epochs=2000"});
  REQUIRE_MESSAGE(early.code == 0, early.text);
  CHECK_MESSAGE(contains(early.text, "stopped early at step"), early.text);
  CHECK(clips.losses("early").size() == 6);  // three epochs of two steps
}

TEST_CASE("hyperparameters: presets, files, single ones; unknown names with the nearest") {
  const Clips clips;
  auto print = [&](const std::string& command, std::vector<std::string> more) {
    more.insert(more.begin(), {command, "--print-config"});
    return run(more, clips.path);
  };
  const auto tmr = print("train-tmr", {});
  CHECK(tmr.code == 0);
  for (const char* line : {"\"latent_dim\": 256", "\"num_layers\": 6", "\"contrastive\": 0.1", "\"temperature\": 0.1",
                           "\"threshold\": 0.8", "\"batch\": 32", "\"epochs\": 500", "\"seed\": 1234"})
    CHECK_MESSAGE(contains(tmr.text, line), line);
  const auto temos = print("train-temos", {"--preset", "temos-published"});
  for (const char* line : {"\"features\": \"rifke64\"", "\"epochs\": 1001", "\"min_seconds\": 0.8"})
    CHECK_MESSAGE(contains(temos.text, line), temos.text);
  for (const char* line : {"\"num_layers\": 8", "\"batch\": 20", "\"epochs\": 5000", "\"num_frames\": 60"})
    CHECK_MESSAGE(contains(print("train-actor", {}).text, line), line);
  ml::write_file(clips / "mine.json", "{\"losses\": {\"kl\": 0.5}, \"optimiser\": {\"batch\": 7}}");
  const auto mine =
      print("train-tmr", {"--config", "mine.json", "--set", "optimiser.batch=9", "--set", "features=rifke"});
  for (const char* line : {"\"kl\": 0.5", "\"batch\": 9", "\"features\": \"rifke\""})
    CHECK_MESSAGE(contains(mine.text, line), line);

  auto refused = [&](std::vector<std::string> more, const std::string& message, int code = 1) {
    const auto out = print("train-tmr", std::move(more));
    CHECK(out.code == code);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  ml::write_file(clips / "wrong.json", "{\"losses\": {\"kll\": 0.5}}");
  refused({"--config", "wrong.json"}, "wrong.json: losses: has no member 'kll'; did you mean 'kl'?");
  refused({"--set", "optimizer.lr=1"}, "has no member 'optimizer'; did you mean 'optimiser'?");
  refused({"--set", "network.num_layers=many"}, "network.num_layers");
  refused({"--preset", "large"}, "--preset 'large' is not tmr-published or small", 2);
}

TEST_CASE("a folder for results that cannot be made is refused before motions are read") {
  const Clips clips;
  for (const char* command : {"train-tmr", "train-temos", "train-actor", "train-classifier"}) {
    const auto out = clips.train(command, "captions.tsv");
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, "[motionlang.io.401] --out captions.tsv: "), out.text);
    CHECK_MESSAGE(!contains(out.text, "reading motions"), out.text);
    CHECK_MESSAGE(!contains(out.text, "motions to train on"), out.text);
  }
}

TEST_CASE("tables that cannot be used are refused with file and line") {
  const Clips clips;
  auto refused = [&](const std::string& command, const std::string& option, const std::string& line,
                     const std::string& message) {
    ml::write_file(clips / "wrong.tsv", "# a table\n" + line + "\n");
    const auto out = run({command, "--data", ".", "--preset", "small", "--out", "out", option, "wrong.tsv", "--set",
                          "data.min_seconds=0", "--set", "data.test_share=0"},
                         clips.path);
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, message), out.text);
    CHECK(!std::filesystem::exists(clips / "out/checkpoint.safetensors"));
  };
  const std::string forms = "clip, start, end, parts, captions, or clip, captions";
  refused("train-tmr", "--captions", "clip0\t0\t2\tlegs",
          "wrong.tsv:2: expected " + forms + ", separated by tabs; columns here: 4");
  refused("train-temos", "--captions", "clip0 a person walks",
          "wrong.tsv:2: expected " + forms + ", separated by tabs; columns here: 1");
  refused("train-tmr", "--captions", "# no clip", "wrong.tsv: no line with " + forms);
  refused("train-tmr", "--captions", "clip0\ta person walks | ", "wrong.tsv:2: an empty text");
  refused("train-temos", "--captions", "clip0\t0\t2\twings\ta person flies", "wrong.tsv:2: 'wings' is no body part");
  refused("train-tmr", "--captions", "clip0\t0\t2\tlegs\ta person walks | ", "wrong.tsv:2: an empty text");
  refused("train-tmr", "--captions", "clip9\t0\t2\tlegs\ta person walks", "wrong.tsv:2: there is no ./clip9.bvh");
  refused("train-actor", "--labels", "clip0\tsoon\t2\twalk", "wrong.tsv:2: 'soon' is not a time");
  refused("train-actor", "--labels", "clip0\t0\t2\twalk\tturn", "wrong.tsv:2: expected clip, start, end, label");
  refused("train-classifier", "--labels", "clip0\t1\t1.1\twalk", "wrong.tsv:2: clip0 1 to 1.1 s holds");
}

TEST_CASE("segments of one start are different motions, captions of one segment on two lines are of one") {
  const Clips clips;
  ml::write_file(clips / "captions.tsv",
                 "clip0\t0\t1\tlegs\ta person walks\nclip0\t0\t2\tlegs\ta person walks ahead\n"
                 "clip0\t0\t2\tleft arm\tsomeone swings an arm\nclip1\t0\t2\tlegs\ta person turns left\n"
                 "clip1\tsomeone turns\n");
  const auto trained =
      train_tiny("train-tmr", clips.path,
                 {"--data", ".", "--captions", "captions.tsv", "--set", "data.min_seconds=0.5", "--set",
                  "data.test_share=0", "--set", "data.validation_share=0", "--set", "data.mirror=false"});
  REQUIRE_MESSAGE(trained.code == 0, trained.text);
  CHECK_MESSAGE(contains(trained.text, "4 motions to train on, 0 for validation, 0 for tests; 0 left out"),
                trained.text);
  for (const char* id : {"clip0@0-1", "clip0@0-2", "clip1@0-2", "clip1"}) {
    CAPTURE(id);
    ml::write_file(clips / "ids.txt", std::string(id) + "\n");
    const auto measured = run({"evaluate", "out/model", "--data", ".", "--captions", "captions.tsv", "--part",
                               "training", "--nsim", "ids.txt"},
                              clips.path);
    CHECK_MESSAGE(measured.code == 0, measured.text);
  }
}

TEST_CASE("a table of clips and captions: each line is about all of a clip") {
  const Clips clips;
  std::string whole, segments;
  for (int i = 0; i < 8; ++i) {
    const std::string name = "clip" + std::to_string(i),
                      captions = i % 2 == 1 ? "a person turns left | someone turns" : "a person walks ahead";
    whole += name + "\t" + captions + "\n";
    segments += name + "\t0\t" + ml::concat_text((40 + 2 * i) / 20.0) + "\tleft arm,right arm,legs,spine,head\t" +
                captions + "\n";
  }
  ml::write_file(clips / "whole.tsv", whole);
  ml::write_file(clips / "segments.tsv", segments);
  for (const char* command : {"train", "train-tmr", "train-temos"}) {
    CAPTURE(command);
    std::vector<std::vector<float>> losses;
    for (const char* table : {"whole.tsv", "segments.tsv"}) {
      const std::vector<std::string> sources{"--data", ".", "--captions", table};
      std::vector<std::string> tiny{"train",    "--out", "out",          "--fresh", "--steps",        "4",
                                    "--batch",  "2",     "--width",      "16",      "--feed-forward", "24",
                                    "--layers", "1",     "--vocabulary", "40",      "--text-steps",   "2"};
      tiny.insert(tiny.end(), sources.begin(), sources.end());
      const auto trained =
          command == std::string("train") ? run(tiny, clips.path) : train_tiny(command, clips.path, sources);
      REQUIRE_MESSAGE(trained.code == 0, trained.text);
      losses.push_back(clips.losses("out"));
    }
    CHECK(!losses[0].empty());
    CHECK(losses[0] == losses[1]);
  }
}

TEST_CASE("data in the form of HumanML3D, and from an annotation file") {
  const Clips clips;
  auto train = [&](const std::vector<std::string>& more) { return train_tiny("train-tmr", clips.path, more); };
  const std::string folder = (clips / "h3d").string();
  for (const char* id : {"000000", "000001", "000002"}) add_walk(folder, id, 60, "guoh3d", ml::humanml3d_form);
  ml::write_ids(folder + "/train.txt", std::vector<std::string>{"000000", "000002"});
  ml::write_ids(folder + "/test.txt", std::vector<std::string>{"000001"});
  const auto h3d = train({"--data", "h3d"});
  REQUIRE_MESSAGE(h3d.code == 0, h3d.text);
  CHECK_MESSAGE(contains(h3d.text, "2 motions to train on, 0 for validation, 1 for tests; 0 left out"), h3d.text);
  auto broken = ml::HumanMl3dFolder(folder).load("000002");
  broken.id = "000003", broken.features[700] = std::nanf("");
  ml::write_humanml3d_clip(folder, broken);
  ml::write_ids(folder + "/train.txt", std::vector<std::string>{"000000", "000002", "000003"});
  CHECK(contains(train({"--data", "h3d"}).text, "2 motions to train on, 0 for validation, 1 for tests; 1 left out"));
  CHECK(
      contains(train({"--data", "h3d", "--set", "features=rifke"}).text,
               "h3d holds ready-made features, which are guoh3d (263 numbers) or kit (251 numbers); the configuration "
               "wants 'rifke' (67)"));

  ml::write_file(clips / "annotations.json", R"({
    "00000": {"path": "clip0", "duration": 2, "annotations": [
      {"seg_id": "00000_0", "text": "a person walks", "start": 0.0, "end": 1.5},
      {"seg_id": "00000_1", "text": "a person starts", "start": 0.0, "end": 0.4}]},
    "00001": {"path": "clip1", "duration": 2, "annotations": [
      {"seg_id": "00001_0", "text": "a person turns", "start": 0.5, "end": 2.0}]},
    "00002": {"path": "clip2", "duration": 2, "annotations": [
      {"seg_id": "00002_0", "text": "a person walks", "start": 0.0, "end": 0.6}]}})");
  std::filesystem::create_directories(clips / "splits");
  ml::write_ids((clips / "splits/train.txt").string(), std::vector<std::string>{"00000", "00001"});
  ml::write_ids((clips / "splits/test.txt").string(), std::vector<std::string>{"00002"});
  const std::vector<std::string> annotated{"--data",   ".",      "--annotations", "annotations.json",
                                           "--splits", "splits", "--set",         "data.min_seconds=1"};
  const auto unified = train(annotated);
  REQUIRE_MESSAGE(unified.code == 0, unified.text);
  CHECK_MESSAGE(contains(unified.text, "2 motions to train on, 0 for validation, 1 for tests; 1 left out"),
                unified.text);
  CHECK_MESSAGE(contains(unified.text, "2 different texts"), unified.text);

  // ready-made features of a path; one clip of them is broken
  std::filesystem::copy(folder + "/new_joint_vecs/000000.npy", clips / "clip0.npy");
  CHECK(contains(train(annotated).text, "2 motions to train on, 0 for validation, 1 for tests; 1 left out"));
  std::filesystem::copy(folder + "/new_joint_vecs/000003.npy", clips / "clip1.npy");
  const auto left_out = train(annotated);
  CHECK_MESSAGE(left_out.code == 0, left_out.text);
  CHECK_MESSAGE(
      contains(left_out.text, "1 motion to train on, 0 for validation, 1 for tests; 2 left out: 1 shorter than 1 s or"),
      left_out.text);
  CHECK_MESSAGE(contains(left_out.text, " s (00000), 1 with numbers that are not finite (00001)\n"), left_out.text);

  // no lists of ids: a quarter of the five clips is one of them, with its two entries and those of its mirrored twin
  std::string entries;
  for (const std::string above : {"", "M/"}) {
    std::filesystem::create_directories(clips / ("lots/" + above));
    for (int clip = 0; clip < 5; ++clip) {
      const std::string path = above + "walk" + std::to_string(clip);
      std::filesystem::copy(folder + "/new_joint_vecs/000000.npy", clips / ("lots/" + path + ".npy"));
      for (const char* of : {"a ", "b "})
        entries += (entries.empty() ? "\"" : ",\"") + (of + path) + R"(": {"path": ")" + path +
                   R"(", "duration": 3, "annotations": [
          {"seg_id": "0", "text": "a person walks", "start": 0, "end": 3}]})";
    }
  }
  ml::write_file(clips / "lots.json", "{" + entries + "}");
  const auto lots = train({"--data", "lots", "--annotations", "lots.json", "--set", "data.test_share=0.25", "--set",
                           "data.validation_share=0.25"});
  CHECK_MESSAGE(contains(lots.text, "12 motions to train on, 4 for validation, 4 for tests; 0 left out"), lots.text);
}

TEST_CASE("actions of whole clips, of ready-made features, of annotation files: unified ones and BABEL's own") {
  const Clips clips;
  const auto train = [&](std::vector<std::string> more, const std::string& command = "train-classifier") {
    std::vector<std::string> all{command, "--preset", "small", "--out", "out", "--fresh"};
    for (const char* a : {"optimiser.epochs=2", "optimiser.batch=2", "clips.num_frames=12"})
      all.insert(all.end(), {"--set", a});
    if (command == "train-classifier") all.insert(all.end(), {"--set", "hidden_size=8"});
    all.insert(all.end(), more.begin(), more.end());
    return run(all, clips.path);
  };
  const auto told = [&](const std::vector<std::string>& more, const std::string& counts, const std::string& actions) {
    const auto out = train(more);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    CHECK_MESSAGE(contains(out.text, counts + " left out"), out.text);
    const auto info = run({"info", "out/model"}, clips.path).text;
    CHECK_MESSAGE(contains(info, "actions                  " + actions + "\n"), info);
  };
  const auto refused = [&](const std::vector<std::string>& more, const std::string& message) {
    const auto out = train(more);
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };

  // a label for all of a clip, as for a stretch that ends after it; features with rotations, as the clips that they are
  // made of
  std::string whole, stretches, shorter;
  std::filesystem::create_directories(clips / "features");
  const auto& features = ml::motion_features("smplvelp");
  for (int i = 0; i < 8; ++i) {
    const std::string name = "clip" + std::to_string(i), label = i % 2 == 1 ? "\tturn\n" : "\twalk\n";
    whole += name + label, stretches += name + "\t0\t9" + label, shorter += name + "\t0\t1" + label;
    const auto motion = ml::resample(ml::retarget(ml::read_bvh_motion(clips / (name + ".bvh"))), features.fps);
    const auto rows = features.from_motion(motion);
    const std::vector<float> values(rows.begin(), rows.end());
    ml::write_npy((clips / ("features/" + name + ".npy")).string(),
                  ml::NpyArray::of(std::span<const float>(values), {motion.frames(), features.width}));
  }
  ml::write_file(clips / "whole.tsv", whole);
  ml::write_file(clips / "stretches.tsv", stretches);
  ml::write_file(clips / "shorter.tsv", shorter);
  const auto losses = [&](const std::string& table, const std::string& data) {
    told({"--data", data, "--labels", table, "--set", "clips.fps=12.5", "--set", "data.test_share=0.25"},
         "6 motions to train on, 0 for validation, 2 for tests; 0", "turn, walk");
    return clips.losses("out");
  };
  const auto of_clips = losses("whole.tsv", ".");
  CHECK(of_clips == losses("stretches.tsv", "."));
  CHECK(of_clips != losses("shorter.tsv", "."));
  const auto of_features = losses("whole.tsv", "features");
  REQUIRE(of_features.size() == of_clips.size());
  for (std::size_t i = 0; i < of_clips.size(); ++i) CHECK(of_features[i] == doctest::Approx(of_clips[i]).epsilon(1e-3));
  ml::write_file(clips / "wrong.tsv", "clip0\t2\twalk\n");
  refused({"--data", ".", "--labels", "wrong.tsv"},
          "wrong.tsv:1: expected clip, start, end, label, or clip, label, separated by tabs");
  refused({"--data", "."}, "actions need labels: --labels names a table of them, --annotations a file that has some");
  const auto texts = clips.train("train-tmr", "texts", {"--set", R"(data.actions=["walk"])"});
  CHECK(texts.code == 1);
  CHECK_MESSAGE(contains(texts.text, "data.actions are labels, and texts are to be learnt"), texts.text);

  // data sets in the form of HumanML3D and KIT-ML have lists of their own; one clip is broken
  for (const auto& kind :
       {std::pair(std::string("guoh3d"), ml::humanml3d_form), {std::string("kit"), ml::kit_ml_form}}) {
    CAPTURE(kind.first);
    const auto& [set, form] = kind;
    const std::string folder = (clips / set).string();
    for (int i = 0; i < 4; ++i)
      add_walk(folder, "00000" + std::to_string(i), 60, set, form, {.turn = i % 2 == 1 ? 0.8 : 0.0});
    auto broken = ml::HumanMl3dFolder(folder, form).load("000003");
    broken.features[700] = std::nanf("");
    ml::write_humanml3d_clip(folder, broken, form);
    ml::write_ids(folder + "/train.txt", std::vector<std::string>{"000000", "000001", "000003"});
    ml::write_ids(folder + "/test.txt", std::vector<std::string>{"000002"});
    ml::write_file(clips / "ids.tsv", "000000\twalk\n000001\tturn\n000002\twalk\n000003\tturn\n");
    told({"--data", set, "--labels", "ids.tsv"}, "2 motions to train on, 0 for validation, 1 for tests; 1",
         "turn, walk");
    const auto measured =
        run({"evaluate", "out/model", "--data", set, "--labels", "ids.tsv", "--seeds", "2"}, clips.path);
    CHECK_MESSAGE(contains(measured.text, "1 motion of the test part, 2 classes"), measured.text);
    refused({"--data", set}, "actions need labels");
  }

  // the unified annotation file, with labels of its own or by a table for stretches, motions and texts
  ml::write_file(clips / "unified.json", R"({
    "00000": {"path": "clip0", "duration": 2, "annotations": [
      {"seg_id": "00000_0", "text": "a person walks", "start": 0.0, "end": 1.5, "label": "walk"},
      {"seg_id": "00000_1", "text": "a person turns", "start": 0.5, "end": 2.0, "act_cat": ["turn"]},
      {"seg_id": "00000_2", "text": "a person stands", "start": 0.0, "end": 2.0}]},
    "00001": {"path": "clip1", "duration": 2, "annotations": [
      {"seg_id": "00001_0", "text": "a person turns", "start": 0.0, "end": 2.0, "label": "turn"}]},
    "00002": {"path": "clip2", "duration": 2, "annotations": [
      {"seg_id": "00002_0", "text": "a person walks", "start": 0.0, "end": 1.2, "label": "walk"},
      {"seg_id": "00002_1", "text": "a person walks", "start": 2.15, "end": 2.3, "label": "walk"}]}})");
  std::filesystem::create_directories(clips / "splits");
  ml::write_ids((clips / "splits/train.txt").string(), std::vector<std::string>{"00000", "00001"});
  ml::write_ids((clips / "splits/test.txt").string(), std::vector<std::string>{"00002"});
  const std::vector<std::string> unified{"--data", ".", "--annotations", "unified.json", "--splits", "splits"};
  const auto with = [](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  told(unified, "3 motions to train on, 0 for validation, 1 for tests; 2",
       "turn, walk");  // without label; a moment after the end
  told(with(unified, {"--set", R"(data.actions=["turn"])"}), "2 motions to train on, 0 for validation, 0 for tests; 4",
       "turn");
  ml::write_file(clips / "said.tsv", "00000_1\tspin\n00001\tspin\na person walks\tstroll\n");
  told(with(unified, {"--labels", "said.tsv"}), "3 motions to train on, 0 for validation, 1 for tests; 2",
       "spin, stroll");
  const auto actor = train(with(unified, {"--set", "network.latent_dim=8", "--set", "network.ff_size=8", "--set",
                                          "network.num_heads=2", "--set", "network.num_layers=1"}),
                           "train-actor");
  REQUIRE_MESSAGE(actor.code == 0, actor.text);
  CHECK(run({"generate", "--model", "out/model", "--action", "turn", "--seconds", "0.8"}, clips.path).code == 0);
  ml::write_file(clips / "elsewhere.tsv", "00009\twalk\n");
  refused(with(unified, {"--labels", "elsewhere.tsv"}),
          "unified.json: elsewhere.tsv has a label for none of its stretches");
  refused(with(unified, {"--labels", "stretches.tsv"}),
          "stretches.tsv:1: expected the id of a stretch or of a motion, or a text, and its label");
  ml::write_file(clips / "twice.tsv", "00001\twalk\n00001\tturn\n");
  refused(with(unified, {"--labels", "twice.tsv"}), "twice.tsv:2: '00001' has a label already");
  ml::write_file(clips / "texts.json", R"({"00000": {"path": "clip0", "duration": 2, "annotations": [
      {"seg_id": "00000_0", "text": "a person walks", "start": 0.0, "end": 1.5}]}})");
  refused({"--data", ".", "--annotations", "texts.json"},
          "texts.json: no annotation has a label or act_cat; --labels names a table");

  // BABEL's own file: stretches where there are some, else the whole; one category, of those that are asked for
  std::filesystem::create_directories(clips / "cmu");
  for (const std::string name : {"clip0", "clip1"})
    std::filesystem::copy(clips / (name + ".bvh"), clips / ("cmu/" + name + ".bvh"));
  const auto label = [](const std::string& seg, const std::string& categories, const std::string& times) {
    return R"({"raw_label": "", "proc_label": ")" + seg + R"(", "seg_id": ")" + seg + R"(", "act_cat": )" + categories +
           times + "}";
  };
  const auto annotation = [](const std::string& labels) {
    return R"({"babel_lid": "0", "anntr_id": "0", "mul_act": true, "labels": [)" + labels + "]}";
  };
  ml::write_file(clips / "babel.json",
                 R"({"10": {"babel_sid": 10, "url": "", "feat_p": "cmu/cmu/clip0.npz", "dur": 2.0, "seq_ann": )" +
                     annotation(label("all", R"(["run"])", "")) + R"(, "frame_ann": )" +
                     annotation(label("a", R"(["walk"])", R"(, "start_t": 0, "end_t": 1.2)") + "," +
                                label("b", R"(["turn", "walk"])", R"(, "start_t": 0.5, "end_t": 2)") + "," +
                                label("c", "null", R"(, "start_t": 0, "end_t": 2)")) +
                     R"(}, "11": {"babel_sid": 11, "url": "", "feat_p": "cmu/cmu/clip1.npz", "dur": 2.1, "seq_ann": )" +
                     annotation(label("d", R"(["turn"])", "")) + R"(, "frame_ann": null}})");
  const std::vector<std::string> babel{"--data", ".", "--annotations", "babel.json", "--set", "data.test_share=0"};
  told(babel, "2 motions to train on, 0 for validation, 0 for tests; 2", "turn, walk");
  const auto measured =
      run({"evaluate", "out/model", "--data", ".", "--annotations", "babel.json", "--part", "training", "--seeds", "2"},
          clips.path);
  CHECK_MESSAGE(contains(measured.text, "2 motions of the training part, 2 classes"), measured.text);
  told(with(babel, {"--set", R"(data.actions=["turn", "run"])"}),
       "2 motions to train on, 0 for validation, 0 for tests; 2", "turn");
}

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
    return ml::guoh3d_joints(std::span<const double>(rows), 21);
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
    CHECK(contains(rest.text, "going on at step "));
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

TEST_CASE("data in the form of KIT-ML: known by the width of their rows, trained on, measured, generated, searched") {
  const TemporaryFolder place;
  const auto said = [&](const std::vector<std::string>& arguments) {
    const auto out = run(arguments, place.path);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return out.text;
  };
  // 30 rows are enough for KIT-ML, though not for HumanML3D; 20 are not
  const std::string kit = (place / "kit").string();
  for (const auto& [id, rows] : {std::pair{"00001", 30}, {"00002", 60}, {"00003", 40}, {"00004", 40}, {"00005", 20}})
    add_walk(kit, id, rows, "kit", ml::kit_ml_form);
  ml::write_ids(kit + "/train.txt", std::vector<std::string>{"00001", "00002", "00005"});
  ml::write_ids(kit + "/test.txt", std::vector<std::string>{"00003", "00004"});

  const std::vector<std::string> one_epoch{"--data", "kit", "--set", "optimiser.epochs=1"};
  const auto tmr = train_tiny("train-tmr", place.path, one_epoch);
  REQUIRE_MESSAGE(tmr.code == 0, tmr.text);
  CHECK_MESSAGE(contains(tmr.text, "2 motions to train on, 0 for validation, 2 for tests; 1 left out"), tmr.text);
  CHECK(ml::read_model_folder(place / "out/model").features == "kit");
  CHECK(ml::read_model_folder(place / "out/model").fps == 12.5);
  CHECK(contains(said({"info", "out/model"}), "kit, 12.5 frames per second"));
  const auto evaluated = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"evaluate", "out/model", "--data", "kit"});
    return said(more);
  };
  const auto measured = evaluated({"--synthesis"});
  for (const char* word : {"2 motions of the test part", "text to motion", "  generated"})
    CHECK_MESSAGE(contains(measured, word), measured);
  CHECK(contains(evaluated({"--synthesis", "--generator", "out/model"}), "  generated"));
  CHECK(contains(evaluated({"--moments", "2", "--joined", "2"}), "4 texts in 2 motions"));

  said({"generate", "--model", "out/model", "--text", "a person walks", "--seconds", "2", "--out", "made"});
  const auto made = ml::read_bvh_motion(place / "made/a_person_walks.bvh");
  CHECK(made.frames() == 25);
  CHECK(made.skeleton.names == ml::kit21_skeleton().names);
  // .bvh, .glb, .npz, .npy
  CHECK(contains(said({"index", "made", "--model", "out/model", "-o", "moves.index"}), "4 clips"));
  CHECK(contains(said({"search", "moves.index", "a person walks"}), "made/a_person_walks.bvh"));
  CHECK(contains(said({"search", "moves.index", "--like", "made/a_person_walks.bvh", "--top", "1"}), "  1  1.000"));

  // a clip on the joints of KIT is denoised as it is, not on SMPL's
  ml::Motion on_mmm = ml::retarget(synthetic::walk({.frames = 60, .turn = 0.5}), ml::kit21_skeleton());
  for (const char* arm : {"LE", "RE", "LW", "RW"}) {  // longer arms than SMPL's
    auto& bone = on_mmm.skeleton.offsets[static_cast<std::size_t>(on_mmm.skeleton[arm])];
    bone = 1.5 * bone;
  }
  ml::write_bvh(place / "mmm.bvh", on_mmm);
  said({"convert", "mmm.bvh", "clean.bvh", "--denoise", "out/model"});
  const auto clean = ml::read_bvh_motion(place / "clean.bvh"), read = ml::read_bvh_motion(place / "mmm.bvh");
  CHECK(clean.skeleton.names == ml::kit21_skeleton().names);
  CHECK(clean.fps == doctest::Approx(20));
  const auto model = program::load_text_motion<ml::Tmr, ml::EigenBackend<float>>(
      place / "out/model", program::read_text_motion_config(place / "out/model"));
  const auto differs_from = [&](const ml::Motion& seen) {
    const auto rows = models::denoised(model.system, model.motion_normalizer, ml::motion_features("kit"), seen, 12.5);
    const auto expected = ml::resample(rows, 20);
    const auto common = std::min(expected.frames(), clean.frames());
    CHECK(std::abs(expected.frames() - clean.frames()) <= 1);
    return synthetic::largest_distance(
        ml::crop(ml::placed(expected, ml::placement_between(expected, 0, clean, 0)), 0, common),
        ml::crop(clean, 0, common));
  };
  CHECK(differs_from(read) < 1e-2);
  CHECK(differs_from(ml::retarget(read)) > 2e-2);

  const auto temos = train_tiny("train-temos", place.path, one_epoch);
  REQUIRE_MESSAGE(temos.code == 0, temos.text);
  const auto errors = evaluated({"--samples", "2"});
  const auto at = errors.find("  mean pose");
  REQUIRE_MESSAGE(at != errors.npos, errors);
  const double way = std::stod(errors.substr(at + 11));  // of the root, in thousands of KIT's units
  CHECK_MESSAGE((way > 0.1 && way < 10), errors);

  // rows of another width, of another data set, of both
  auto refused = [&](std::vector<std::string> more, const std::string& message) {
    more.insert(more.begin(), {"--data", "kit"});
    const auto out = train_tiny("train-tmr", place.path, more);
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  refused({"--set", "features=guoh3d"}, "kit/new_joint_vecs/00001.npy: an array (30, 251), expected (30, 263)");

  // the data set's own statistics in place of those of the motions to train on
  refused({"--statistics", "kit"}, "[motionlang.io.401] kit: no statistics of the motions");
  const std::vector<float> quarters(251, 0.25f), more_quarters(263, 0.25f);
  ml::write_npy(kit + "/Mean.npy", ml::NpyArray::of(std::span<const float>(more_quarters), {263}));
  ml::write_npy(kit + "/Std.npy", ml::NpyArray::of(std::span<const float>(quarters), {251}));
  refused({"--statistics", "kit"}, "[motionlang.io.407]");
  ml::write_npy(kit + "/Mean.npy", ml::NpyArray::of(std::span<const float>(quarters), {251}));
  auto with_statistics = one_epoch;
  with_statistics.insert(with_statistics.end(), {"--statistics", "kit"});
  const auto own = train_tiny("train-tmr", place.path, with_statistics);
  REQUIRE_MESSAGE(own.code == 0, own.text);
  const auto weights = ml::SafetensorsFile::open(place / "out/model/weights.safetensors");
  CHECK(ml::values_of<float>(weights.tensor("motion_normalizer.mean")) == quarters);
  CHECK(ml::values_of<float>(weights.tensor("motion_normalizer.std")) == quarters);

  add_walk((place / "h3d").string(), "000000", 60, "guoh3d", ml::humanml3d_form);
  ml::write_ids(place / "h3d/train.txt", std::vector<std::string>{"000000"});
  const auto other = run({"evaluate", "out/model", "--data", "h3d", "--part", "training"}, place.path);
  CHECK(other.code == 1);
  CHECK_MESSAGE(contains(other.text, "h3d/new_joint_vecs/000000.npy: an array (60, 263), expected (60, 251)"),
                other.text);
  add_walk(kit, "00006", 60, "guoh3d", ml::humanml3d_form);
  ml::write_ids(kit + "/train.txt", std::vector<std::string>{"00001", "00006"});
  refused({}, "kit/new_joint_vecs/00006.npy: an array (60, 263), expected (60, 251)");
  const std::vector<float> rows(4 * 100);
  ml::write_npy(kit + "/new_joint_vecs/00001.npy", ml::NpyArray::of(std::span<const float>(rows), {4, 100}));
  refused({},
          "kit/new_joint_vecs/00001.npy: an array (4, 100), expected rows of guoh3d (263 numbers) or kit (251 "
          "numbers)");

  // ready-made rows of KIT-ML that an annotation file names; of HumanML3D among them
  ml::write_file(place / "annotations.json", R"({
    "00002": {"path": "00002", "duration": 4.8, "annotations": [
      {"seg_id": "0", "text": "a person walks", "start": 0, "end": 4.8}]},
    "00003": {"path": "00003", "duration": 3.2, "annotations": [
      {"seg_id": "0", "text": "someone walks", "start": 0, "end": 3.2}]},
    "00006": {"path": "00006", "duration": 3, "annotations": [{"seg_id": "0", "text": "a walk", "start": 0, "end": 3}]}})");
  const std::vector<std::string> annotated{"--data",           "kit/new_joint_vecs", "--annotations",
                                           "annotations.json", "--splits",           "kit"};
  ml::write_ids(kit + "/train.txt", std::vector<std::string>{"00002", "00003"});
  const auto unified = train_tiny("train-tmr", place.path, annotated);
  REQUIRE_MESSAGE(unified.code == 0, unified.text);
  CHECK(contains(unified.text, "2 motions to train on, 0 for validation, 0 for tests; 0 left out"));
  CHECK(ml::read_model_folder(place / "out/model").features == "kit");
  CHECK(contains(said({"train-tmr", "--print-config"}), "\"features\": \"guoh3d\""));
  ml::write_ids(kit + "/train.txt", std::vector<std::string>{"00002", "00003", "00006"});
  const auto both = train_tiny("train-tmr", place.path, annotated);
  CHECK(both.code == 1);
  CHECK_MESSAGE(contains(both.text, "00006.npy: an array (60, 263), expected (60, 251)"), both.text);
}
