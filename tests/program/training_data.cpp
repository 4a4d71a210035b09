// The data that trainings read: tables, folders of data sets, annotation files.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/kinematics/root_motion.hpp>
#include <motionlang/metrics/ape_ave.hpp>
#include <motionlang/weights/model_folder.hpp>
#include <motionlang/weights/text_motion_model.hpp>

#include "../support/denoised.hpp"
#include "../support/made_up_humanml3d.hpp"
#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"
#include "training_clips.hpp"

TEST_CASE("clips that only their extensions tell apart do not get each other's captions and labels") {
  const Clips clips;
  ml::write_amass(clips / "clip0.npz", synthetic::walk({.frames = 44, .turn = 0.8}));
  const auto doubt = [&](const Outcome& out, const std::string& place) {
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, "[motionlang.io.403] " + place +
                                         ": 'clip0' may be clip0.bvh or clip0.npz: add its extension"),
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
  const std::string forms = "clip, start, end, parts, captions[, how it goes on], or clip, captions";
  refused("train-tmr", "--captions", "clip0\t0\t2\tlegs",
          "wrong.tsv:2: expected " + forms + ", separated by tabs; columns here: 4");
  refused("train-temos", "--captions", "clip0 a person walks",
          "wrong.tsv:2: expected " + forms + ", separated by tabs; columns here: 1");
  refused("train-tmr", "--captions", "# no clip", "wrong.tsv: no line with " + forms);
  refused("train-tmr", "--captions", "clip0\ta person walks | ", "wrong.tsv:2: an empty text");
  refused("train-temos", "--captions", "clip0\t0\t2\twings\ta person flies", "wrong.tsv:2: 'wings' is not a body part");
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
  CHECK_MESSAGE(contains(texts.text, "data.actions selects labels, but this training learns texts"), texts.text);

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
          "unified.json: elsewhere.tsv has no label for any of its segments");
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
  const auto model = ml::load_text_motion<ml::Tmr, ml::EigenBackend<float>>(
      place / "out/model", ml::read_text_motion_config(place / "out/model"));
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

TEST_CASE("HumanML3D is made from AMASS; missing files are reported first; the same command continues") {
  const made_up::HumanMl3d place;
  const std::vector<std::string> command{"humanml3d", "--repository", "repository", "--amass", "AMASS",
                                         "--bodies",  "bodies",       "--out",      "out"};
  const auto with = [&](const std::string& option) {
    auto all = command;
    all.push_back(option);
    return run(all, place.path);
  };
  const Outcome missing = run(command, place.path);
  CHECK(missing.code == 1);
  CHECK_MESSAGE(contains(missing.text,
                         "1 of 3 sources of index.csv are missing below AMASS and in pose_data of repository, "
                         "such as ./pose_data/KIT/3/kick_poses.npy; --missing leaves their clips out"),
                missing.text);
  const Outcome made = with("--missing");
  CHECK(made.code == 0);
  CHECK_MESSAGE(contains(made.text,
                         "out: 4 clips made, 0 were there, 2 without captions, 0 with values that are not "
                         "finite\n2 left out: 2 without their source (000002)"),
                made.text);
  CHECK(contains(with("--missing").text, "out: 0 clips made, 4 were there"));
  const ml::HumanMl3dFolder data(place.out);
  CHECK(data.load("M000000").frames == 57);
  // the smallest training reads it
  const Outcome trained = train_tiny("train-tmr", place.path, {"--data", "out"});
  CHECK_MESSAGE(contains(trained.text, "2 motions to train on"), trained.text);
}
