// The commands train-tmr and train-temos on a few made-up clips, in seconds, and what all trainings share.
#include <doctest/doctest.h>

#include <map>
#include <set>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/metrics/ape_ave.hpp>
#include <motionlang/weights/text_motion_model.hpp>
#include <motionlang/weights/word_vector_file.hpp>

#include "../support/body_arrays.hpp"
#include "../support/raw_kit.hpp"
#include "training_clips.hpp"

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
    CHECK(contains(rest.text, "continuing at step 48 of 100"));
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
  const auto curves = shell(
      "motionlang evaluate train-tmr_whole/model --data . --captions captions.tsv --part training "
      "--moments 3 --joined 2 --windows 0.5,1.5 | tail -n +2 > moments.txt && motionlang figure curves moments.txt "
      "--rows -o 5_10.svg",
      clips.path);
  CHECK_MESSAGE((curves.code == 0 && std::filesystem::exists(clips / "5_10.svg")), curves.text);
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
    CHECK_MESSAGE(contains(steps.text, "--steps, --sampler, --noise-factor and --guidance are for diffusion models"),
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
    CHECK(contains(rest.text, "continuing at step 4 of 8"));
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
      const auto read = ml::load_text_motion<ml::Tmr, ml::EigenBackend<float>>(
          clips / model, ml::read_text_motion_config(clips / model));
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

TEST_CASE("raw KIT-ML, by its own positions and by its motions in AMASS, at 100 frames per second") {
  const TemporaryFolder folder;
  std::string paths;
  std::filesystem::create_directories(folder / "kit/amass/KIT/3");
  for (int i = 0; i < 8; ++i) {
    const std::string id = "0000" + std::to_string(i);
    const auto walk = synthetic::walk({.frames = 160 + 8 * i, .fps = 100, .turn = 0.2 * i});
    raw_kit::write(folder / "kit", id, raw_kit::joints_of(walk), {"a person walks", "someone turns"});
    ml::write_amass(folder / ("kit/amass/KIT/3/" + id + "_poses.npz"), walk);
    paths += (i == 0 ? "{" : ", ") + ('"' + id) + R"(": {"path": "3/)" + id + R"(_poses.npz", "identifier": "kit"})";
  }
  ml::write_file(folder / "kit/kitml_amass_path.json", paths + "}");
  for (const bool smpl : {false, true}) {
    CAPTURE(smpl);
    const std::vector<std::string> more{"--data", "kit",
                                        "--set",  smpl ? "features=smplvelp" : "features=rifke64",
                                        "--set",  "data.test_share=0.25",
                                        "--set",  "data.min_seconds=0.5"};
    const auto done = train_tiny("train-temos", folder.path, more);
    REQUIRE_MESSAGE(done.code == 0, done.text);
    CHECK_MESSAGE(contains(done.text, "2 for tests; 0 left out"), done.text);
    const std::vector<std::string> measure{"evaluate", "out/model", "--data", "kit", "--samples", "2"};
    const auto measured = run(measure, folder.path);
    REQUIRE_MESSAGE(measured.code == 0, measured.text);
    CHECK_MESSAGE(contains(measured.text, "joints at 100 frames per second; generated ones are interpolated from 12.5"),
                  measured.text);
    CHECK_MESSAGE(contains(measured.text, "mean of the latent"), measured.text);
    if (smpl) continue;
    // figure 4.5 from the last two lines of the table
    const auto drawn = shell(
        "motionlang evaluate out/model --data kit --samples 2 | tail -n 2 | "
        "motionlang figure curves - --rows -o 4_5.svg",
        folder.path);
    CHECK_MESSAGE((drawn.code == 0 && std::filesystem::exists(folder / "4_5.svg")), drawn.text);
    // the recordings as arrays of joints, as if another program had made them
    std::filesystem::create_directories(folder / "lin");
    for (int i = 0; i < 8; ++i) {
      const auto joints = raw_kit::joints_of(synthetic::walk({.frames = 160 + 8 * i, .fps = 100, .turn = 0.2 * i}));
      std::vector<double> values;
      for (const auto& p : joints) values.insert(values.end(), {p.x, p.y, p.z});
      ml::write_npy(folder / ("lin/0000" + std::to_string(i) + ".npy"),
                    ml::NpyArray::of(std::span<const double>(values), {std::ssize(joints) / 21, 21, 3}));
    }
    std::vector<std::string> beside = measure;
    beside.insert(beside.end(), {"--made", "lin", "--made-rate", "100"});
    const auto with_others = run(beside, folder.path);
    REQUIRE_MESSAGE(with_others.code == 0, with_others.text);
    const auto root_error = [&](const std::string& row) {
      const auto at = with_others.text.find("\n  " + row + " ");
      REQUIRE_MESSAGE(at != std::string::npos, with_others.text);
      return std::stod(with_others.text.substr(at + 3 + row.size()));
    };
    CHECK_MESSAGE(root_error("lin") < 0.2 * root_error("mean pose"), with_others.text);
    std::filesystem::remove(folder / "lin/00003.npy");
    std::filesystem::remove(folder / "lin/00004.npy");
    for (const char* id : {"0", "1", "2", "5", "6", "7"})
      std::filesystem::remove(folder / ("lin/0000" + std::string(id) + ".npy"));
    CHECK(contains(run(beside, folder.path).text, "lin: a file is needed for each of 2 motions; 2 left out"));
  }

  // as published: KIT-ML's own splits, the published turn, a language model
  std::filesystem::create_directories(folder / "kit-splits");
  ml::write_ids((folder / "kit-splits/train.txt").string(),
                std::vector<std::string>{"00000", "00001", "00002", "00003"});
  ml::write_ids((folder / "kit-splits/val.txt").string(), std::vector<std::string>{"00004"});
  ml::write_ids((folder / "kit-splits/test.txt").string(), std::vector<std::string>{"00005", "00006"});
  write_distilbert(folder / "language");
  const std::vector<std::string> published{"--data", "kit", "--splits", "kit-splits", "--text-encoder", "language"};
  std::vector<std::string> settings = published;
  settings.insert(settings.end(), {"--set", "features=smplvelp-published", "--set", "text.encoder=distilbert", "--set",
                                   "data.min_seconds=0.5"});
  const auto trained = train_tiny("train-temos", folder.path, settings);
  REQUIRE_MESSAGE(trained.code == 0, trained.text);
  CHECK_MESSAGE(contains(trained.text, "4 motions to train on, 1 for validation, 2 for tests"), trained.text);
  std::vector<std::string> measure = published;
  measure.insert(measure.begin(), {"evaluate", "out/model", "--samples", "1"});
  const auto measured = run(measure, folder.path);
  REQUIRE_MESSAGE(measured.code == 0, measured.text);
  CHECK_MESSAGE(contains(measured.text, "one sample"), measured.text);

  // AMASS by annotations, on MMM's joints of an SMPL-H body
  std::string annotations;
  for (int i = 0; i < 8; ++i) {
    const std::string id = "0000" + std::to_string(i);
    annotations += (i == 0 ? "{\"" : ", \"") + id + R"(": {"path": "KIT/3/)" + id +
                   R"(_poses", "duration": 1.6, "annotations": [{"seg_id": ")" + id +
                   R"(_0", "text": "a person walks", "start": 0.0, "end": 1.6}]})";
  }
  ml::write_file(folder / "annotations.json", annotations + "}");
  auto body = body_arrays::chain(52, 6890, 10);
  for (const std::string side : {"l", "r"}) {
    body.push_back({"hands_components" + side, body_arrays::array(std::vector<double>(90), {2, 45})});
    body.push_back({"hands_mean" + side, body_arrays::array(std::vector<double>(45), {45})});
  }
  ml::write_npz(folder / "SMPLH.npz", body);
  const std::vector<std::string> amass{"--data",           "kit/amass", "--annotations",
                                       "annotations.json", "--splits",  "kit-splits"};
  settings = amass;
  settings.insert(settings.end(), {"--set", "features=smplvelp-published", "--set", "data.min_seconds=0.5"});
  const auto of_amass = train_tiny("train-temos", folder.path, settings);
  REQUIRE_MESSAGE(of_amass.code == 0, of_amass.text);
  measure = amass;
  measure.insert(measure.begin(), {"evaluate", "out/model", "--samples", "1", "--joints", "mmm", "--rate", "12.5",
                                   "--body", "SMPLH.npz"});
  const auto on_mmm = run(measure, folder.path);
  REQUIRE_MESSAGE(on_mmm.code == 0, on_mmm.text);
  CHECK_MESSAGE(contains(on_mmm.text, "MMM's joints of SMPL-H"), on_mmm.text);
}

TEST_CASE("galleries of what TMR finds; motions of another program in its tables") {
  const Clips clips;
  REQUIRE(clips.train("train-tmr", "run").code == 0);
  const std::vector<std::string> measure{"evaluate",   "run/model",    "--data", ".",
                                         "--captions", "captions.tsv", "--part", "training"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), measure.begin(), measure.end());
    return run(more, clips.path);
  };
  write_distilbert(clips / "language");
  const auto shown = with({"--html", "page.html", "--count", "2", "--sentence-encoder", "language"});
  REQUIRE_MESSAGE(shown.code == 0, shown.text);
  CHECK_MESSAGE(contains(shown.text, "2 galleries in page.html"), shown.text);
  const std::string page = ml::read_file(clips / "page.html");
  CHECK(contains(page, "<title>Nearest of 4 motions</title>"));
  std::size_t strips = 0;
  for (auto at = page.find("<svg"); at != page.npos; at = page.find("<svg", at + 1)) ++strips;
  CHECK(strips == 2 * 4);
  CHECK(contains(page, "class=\"own\""));
  // another TMR with its language model judges timelines
  REQUIRE(clips
              .train("train-tmr", "judge",
                     {"--set", "features=guoh3d", "--set", "text.encoder=distilbert", "--text-encoder", "language"})
              .code == 0);
  const std::filesystem::path examples = MOTIONLANG_EXAMPLES;
  const auto judged = run({"evaluate", (examples / "models/stmc_free.safetensors").string(), "--texts",
                           (examples / "training/mtt_texts.txt").string(), "--first", "2", "--steps", "2", "--modes",
                           "one-text", "--tmr", "judge/model", "--tmr-text-encoder", "language"},
                          clips.path);
  REQUIRE_MESSAGE(judged.code == 0, judged.text);
  CHECK_MESSAGE(contains(judged.text, "\n  one text "), judged.text);
  // the clips themselves, by their names: found as the recorded ones
  const auto synthesized = with({"--synthesis", "--made", "."});
  REQUIRE_MESSAGE(synthesized.code == 0, synthesized.text);
  CHECK(synthesized.text != with({"--synthesis"}).text);
  for (const auto& [more, message] :
       {std::pair(std::vector<std::string>{"--made", "."}, "--made is for TEMOS, ACTOR"),
        {{"--synthesis", "--made", ".", "--generator", "run/model"}, "--made are the motions"},
        {{"--moments", "2", "--html", "p.html"}, "--html is about whole motions, --moments about moments in them"},
        {{"--babel", "captions.tsv", "--synthesis"}, "--synthesis is about whole motions, --babel about moments"},
        {{"--dataset", "uestc"}, "--dataset is for ACTOR and the classifier, not tmr"},
        {{"--synthesis", "--made", "run"}, "run: a file is needed for each of 4 motions"}}) {
    const auto refused = with(more);
    CHECK(refused.code != 0);
    CHECK_MESSAGE(contains(refused.text, message), refused.text);
  }
}

TEST_CASE("TMR without the loss of reconstruction, a row of table 5.3") {
  const Clips clips;
  const auto done = clips.train("train-tmr", "out", {"--set", "losses.recons=0", "--set", "optimiser.epochs=1"});
  REQUIRE_MESSAGE(done.code == 0, done.text);
  CHECK(clips.terms("out") == std::vector<std::string>{"kl", "latent", "contrastive"});
  const auto measured = run({"evaluate", "out/model", "--data", ".", "--captions", "captions.tsv"}, clips.path);
  CHECK_MESSAGE(measured.code == 0, measured.text);
}

TEST_CASE("the text encoder may have layers and heads of its own") {
  const Clips clips;
  for (const std::string command : {"train-temos", "train-tmr"}) {
    CAPTURE(command);
    const auto done = clips.train(command, command,
                                  {"--set", "network.num_layers=2", "--set", "network.text_layers=1", "--set",
                                   "network.text_heads=1", "--set", "optimiser.epochs=1"});
    REQUIRE_MESSAGE(done.code == 0, done.text);
    const auto weights = ml::SafetensorsFile::open(clips / (command + "/model/weights.safetensors"));
    std::set<std::string> text, motion;
    for (const auto& t : weights.tensors()) {
      const auto at = t.name.find(".layers.");
      if (at != t.name.npos) (contains(t.name, "text") ? text : motion).insert(t.name.substr(at + 8, 1));
    }
    CHECK(text == std::set<std::string>{"0"});
    CHECK(motion == std::set<std::string>{"0", "1"});
    CHECK(run({"evaluate", command + "/model", "--data", ".", "--captions", "captions.tsv"}, clips.path).code == 0);
  }
  const auto refused = clips.train("train-temos", "refused", {"--set", "network.text_layers=-1"});
  CHECK(refused.code == 1);
  CHECK_MESSAGE(contains(refused.text, "text_layers is -1, expected 0 to 256"), refused.text);
}

TEST_CASE("Ctrl-C keeps a checkpoint, from which the same command goes on; early stop") {
  const Clips clips;
  const auto stopped = clips.train("train-tmr", "run", {"--set", "optimiser.epochs=20000"}, "training [");
  CHECK_MESSAGE(stopped.code == 130, stopped.text);
  CHECK(contains(stopped.text, "the same command continues from run/checkpoint.safetensors"));
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

TEST_CASE("vectors of words and texts that no motion shows are learned with, and the model keeps both") {
  const Clips clips;
  const std::vector<std::string> words{"ahead", "budget", "person", "senate", "stroll", "turns", "walks"};
  std::vector<float> numbers;
  for (std::size_t i = 0; i < words.size(); ++i) {
    for (std::size_t k = 0; k < words.size(); ++k) numbers.push_back(i == k ? 1.0f : 0.0f);
  }
  numbers[4 * words.size() + 6] = 2;  // stroll is nearly walks
  ml::write_word_vectors(clips / "words.safetensors", ml::WordVectors::rounded(words, numbers));
  for (const std::string command : {"train-tmr", "train-temos"}) {
    CAPTURE(command);
    std::vector<std::string> more{"--word-vectors", "words.safetensors", "--set", "optimiser.epochs=4"};
    if (command == "train-tmr")
      more.insert(more.end(), {"--set", "losses.strangers=3", "--set", "text.strange_words=0.5"});
    REQUIRE(clips.train(command, command, more).code == 0);
    more[3] = "optimiser.epochs=2";
    REQUIRE(clips.train(command, command + "_halves", more).code == 0);
    more[3] = "optimiser.epochs=4";
    REQUIRE(clips.train(command, command + "_halves", more).code == 0);
    CHECK(clips.weights(command) == clips.weights(command + "_halves"));
    const auto file = ml::read_text_motion_config(clips / (command + "/model"));
    CHECK(file.similarity.empty() == (command == "train-temos"));
    CHECK(file.config.text.hidden_words == 0.3);
    more.erase(more.begin(), more.begin() + 2);
    const auto without = clips.train(command, command + "_halves", more);
    CHECK(without.code == 1);
    CHECK_MESSAGE(contains(without.text, "text."), without.text);  // other settings than those of the checkpoint
  }
  const auto tmr = ml::load_text_motion<ml::Tmr, ml::EigenBackend<float>>(
      clips / "train-tmr/model", ml::read_text_motion_config(clips / "train-tmr/model"));
  REQUIRE(tmr.words);
  CHECK(tmr.words->vectors.words() == words);
  CHECK(tmr.words->tokenizer.find("walks"));
  const std::vector<std::string> texts{"strolls", "budget"};
  const auto rows = tmr.words->operator()(texts).tokens;
  CHECK(rows[0].to_vector() != rows[1].to_vector());  // neither is a piece

  const auto half =
      run({"convert", "train-tmr/model/weights.safetensors", "half.safetensors", "--store", "F16"}, clips.path);
  REQUIRE_MESSAGE(half.code == 0, half.text);
  std::filesystem::rename(clips / "half.safetensors", clips / "train-tmr/model/weights.safetensors");
  CHECK(run({"index", ".", "--model", "train-tmr/model", "-o", "moves.index"}, clips.path).code == 0);
  const auto found = run({"search", "moves.index", "a person zzyx"}, clips.path);
  CHECK_MESSAGE(contains(found.text, "the word 'zzyx'"), found.text);

  const auto refused =
      clips.train("train-tmr", "refused",
                  {"--word-vectors", "words.safetensors", "--set", "text.encoder=distilbert", "--text-encoder", "."});
  CHECK(refused.code == 2);
  CHECK_MESSAGE(contains(refused.text, "--word-vectors"), refused.text);
  const auto margin =
      clips.train("train-tmr", "refused", {"--set", "losses.strangers=3", "--set", "losses.contrastive_loss=margin"});
  CHECK(margin.code == 1);
  CHECK_MESSAGE(contains(margin.text, "losses.strangers is for info_nce"), margin.text);
}
