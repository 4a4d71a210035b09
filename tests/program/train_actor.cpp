// The commands train-actor and train-classifier on a few made-up clips, in seconds.
#include <doctest/doctest.h>

#include <tuple>

#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/kinematics/root_motion.hpp>
#include <motionlang/metrics/ape_ave.hpp>
#include <motionlang/view/loss_curves.hpp>
#include <motionlang/weights/text_motion_model.hpp>

#include "../support/actor_pickles.hpp"
#include "../support/body_arrays.hpp"
#include "../support/synthetic_motion.hpp"
#include "training_clips.hpp"

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
  const auto body_alone = clips.train("train-actor", "skin_alone", {"--body", "body.npz"});
  CHECK_MESSAGE(contains(body_alone.text, "points   vertices of body.npz"), body_alone.text);
  CHECK(clips.weights("skin_alone") == clips.weights("skin"));
  const auto no_body = clips.train("train-actor", "no_body", {"--set", "optimiser.epochs=1"});
  CHECK_MESSAGE(contains(no_body.text, "points   24 joints of our own skeleton, in place of the published vertices"),
                no_body.text);

  // figure 3.4: accuracy and FID of motions of several lengths, as a table of curves
  const auto drawn = shell(
      "motionlang evaluate first/model --data . --labels labels.tsv --classifier graph/model --seeds 2 --part training "
      "--durations 8,12,20 > out.txt && sed -n '/^#/,$p' out.txt > durations.tsv && "
      "motionlang figure curves durations.tsv -o 3_4.svg",
      clips.path);
  REQUIRE_MESSAGE((drawn.code == 0 && std::filesystem::exists(clips / "3_4.svg")), drawn.text);
  const std::string lengths = ml::read_file(clips / "out.txt");
  CHECK(!contains(lengths, "multimodality"));
  REQUIRE_MESSAGE(contains(lengths, "# accuracy %"), lengths);
  const auto panels = ml::parse_curves(ml::read_file(clips / "durations.tsv"));
  REQUIRE(panels.size() == 2);
  CHECK(panels[0].axis == "frames");
  CHECK(panels[0].curves.at(0).steps == std::vector<double>{8, 12, 20});
  for (const double v : panels[0].curves.at(0).values) CHECK((v >= 0 && v <= 100));
  for (const double v : panels[1].curves.at(0).values) CHECK(v > 0);
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
  CHECK(contains(
      clips
          .train("train-classifier", "no",
                 {"--generated", "first/model", "--set", "generated_share=0.5", "--set", "clips.fps=10"})
          .text,
      "model and classifier have different clips: fps 15, turned_ahead true, translation true, global true and "
      "fps 10"));

  // going on with another set of terms: those of the steps since then
  trained("train-actor", "speeds",
          {"--set", "losses.rc=1", "--set", "losses.rcxyz=0", "--set", "losses.kl=0", "--set", "losses.vel=1", "--set",
           "optimiser.epochs=6", "--other-settings"});
  CHECK(clips.terms("speeds") == std::vector<std::string>{"rc", "vel"});
  CHECK(clips.losses("speeds").size() == 12);
  CHECK(clips.term_values("speeds").size() == 2 * 4);
}

TEST_CASE("actions in the files of their data set, in the world of their camera") {
  const TemporaryFolder folder;
  actor_pickles::write_humanact12(folder / "data", 6);
  const auto train = [&](const std::string& command, const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> all{command,    "--data", "data",  "--dataset", "humanact12",
                                 "--preset", "small",  "--out", out};
    for (const char* a : {"optimiser.epochs=2", "optimiser.batch=3", "clips.num_frames=12", "data.min_seconds=0"})
      all.insert(all.end(), {"--set", a});
    if (command != "train-classifier") {
      for (const char* a : {"network.latent_dim=8", "network.ff_size=8", "network.num_layers=1", "network.num_heads=2"})
        all.insert(all.end(), {"--set", a});
    }
    all.insert(all.end(), more.begin(), more.end());
    return run(all, folder.path);
  };
  for (const char* command : {"train-actor", "train-classifier", "train-mdm-actions"}) {
    const auto done = train(command, command);
    REQUIRE_MESSAGE(done.code == 0, done.text);
    CHECK_MESSAGE(contains(done.text, "6 motions to train on, 0 for validation, 6 for tests; 0 left out"), done.text);
    const std::string config = ml::read_file(folder / command / "model/config.json");
    CHECK_MESSAGE((contains(config, R"("turned_ahead": false)") && contains(config, R"("camera": true)")), config);
  }
  for (const char* part : {"training", "test"}) {
    const auto measured = run({"evaluate", "train-actor/model", "--data", "data", "--dataset", "humanact12",
                               "--classifier", "train-classifier/model", "--seeds", "2", "--part", part},
                              folder.path);
    REQUIRE_MESSAGE(measured.code == 0, measured.text);
    CHECK_MESSAGE(contains(measured.text, "6 motions of the " + std::string(part) + " part, 2 classes"), measured.text);
  }
  CHECK(run({"evaluate", "train-classifier/model", "--data", "data", "--dataset", "humanact12", "--seeds", "2"},
            folder.path)
            .code == 0);
  const auto upright = train("train-actor", "upright", {"--set", "clips.camera=false"});
  REQUIRE_MESSAGE(upright.code == 0, upright.text);
  CHECK(ml::read_file(folder / "upright/model/weights.safetensors") !=
        ml::read_file(folder / "train-actor/model/weights.safetensors"));
  // motions of another program, in a folder for each action
  for (const char* action : {"warm_up", "walk"}) {
    std::filesystem::create_directories(folder / "others" / action);
    for (int i = 0; i < 3; ++i)
      ml::write_bvh(folder / "others" / action / (std::to_string(i) + ".bvh"), synthetic::walk({.frames = 20 + i}));
  }
  const auto beside = run({"evaluate", "train-actor/model", "--data", "data", "--dataset", "humanact12", "--classifier",
                           "train-classifier/model", "--seeds", "2", "--made", "others"},
                          folder.path);
  REQUIRE_MESSAGE(beside.code == 0, beside.text);
  CHECK_MESSAGE(contains(beside.text, "\n  of another program "), beside.text);
  ml::write_file(folder / "labels.tsv", std::string_view("\n"));
  for (const auto& [option, value, message] :
       {std::tuple("--labels", "labels.tsv", "--dataset has labels of its own: no --labels with it"),
        {"--annotations", "labels.tsv", "no --annotations with it"},
        {"--durations", "20", "--durations measures motions of the model, not of --made"}}) {
    const auto refused = run({"evaluate", "train-actor/model", "--data", "data", "--dataset", "humanact12", "--made",
                              "others", option, value},
                             folder.path);
    CHECK_MESSAGE((refused.code == 2 && contains(refused.text, message)), refused.text);
  }
  std::filesystem::create_directories(folder / "splits");
  const auto split = train("train-actor", "refused", {"--splits", "splits"});
  CHECK(split.code != 0);
  CHECK_MESSAGE(contains(split.text, "humanact12 has parts of its own: no --splits with it"), split.text);
  for (const auto& [dataset, message] :
       {std::pair("uestc", "--dataset uestc: data has other files"), {"humanact13", "humanact13"}}) {
    const auto refused = run({"train-actor", "--data", "data", "--dataset", dataset}, folder.path);
    CHECK(refused.code != 0);
    CHECK_MESSAGE(contains(refused.text, message), refused.text);
  }
}

TEST_CASE("ACTOR's presets for UESTC and NTU-13, its second training with several lengths, both parts of UESTC") {
  const TemporaryFolder folder;
  actor_pickles::write_uestc(folder / "uestc", 8, 70);
  actor_pickles::write_ntu13(folder / "ntu13", 4, 70);
  const auto train = [&](const std::string& command, const std::string& dataset, const std::string& preset,
                         const std::string& out, std::vector<std::string> more = {}) {
    std::vector<std::string> all{command, "--data", dataset, "--dataset", dataset, "--preset", preset, "--out", out};
    for (const char* a : {"optimiser.epochs=1", "optimiser.batch=2"}) all.insert(all.end(), {"--set", a});
    if (command == "train-actor") {
      for (const char* a : {"network.latent_dim=8", "network.ff_size=8", "network.num_layers=1", "network.num_heads=2"})
        all.insert(all.end(), {"--set", a});
    }
    all.insert(all.end(), more.begin(), more.end());
    const auto done = run(all, folder.path);
    REQUIRE_MESSAGE(done.code == 0, done.text);
    return done.text;
  };
  CHECK(contains(train("train-actor", "ntu13", "actor-published-ntu13", "ntu"), "4 motions to train on"));
  CHECK(contains(train("train-actor", "uestc", "actor-published-uestc", "actor"), "4 motions to train on"));
  train("train-actor", "uestc", "actor-variable", "variable", {"--from", "actor/model", "--set", "optimiser.lr=0"});
  // nothing is learnt at rate 0, so it is what was gone on from
  CHECK(ml::read_file(folder / "variable/model/weights.safetensors") ==
        ml::read_file(folder / "actor/model/weights.safetensors"));
  train("train-classifier", "uestc", "small", "classifier", {"--set", "clips.fps=30"});
  for (const char* part : {"training", "test"}) {
    const auto measured = run({"evaluate", "variable/model", "--data", "uestc", "--dataset", "uestc", "--classifier",
                               "classifier/model", "--seeds", "2", "--part", part},
                              folder.path);
    REQUIRE_MESSAGE(measured.code == 0, measured.text);
    CHECK_MESSAGE(contains(measured.text, "4 motions of the " + std::string(part) + " part, 2 classes"), measured.text);
  }
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
                 "losses.vertstrans is for points of a body"));

  const std::vector<std::string> gru{"--set", "network.encoder=gru", "--set", "network.decoder=gru"};
  trained("train-actor", "time", gru);
  auto timeless = gru;
  timeless.insert(timeless.end(), {"--set", "network.concatenate_time=false"});
  trained("train-actor", "timeless", timeless);
  CHECK(clips.weights("timeless").size() < clips.weights("time").size());  // a column less
  CHECK(run({"generate", "--model", "timeless/model", "--action", "walk", "--seconds", "0.8"}, clips.path).code == 0);
  // table 3.4: ways in which the decoder reads the action
  trained("train-actor", "action_bias", {});
  for (const std::string conditioning : {"concat_bias", "zandtime", "time_encoding"}) {
    CAPTURE(conditioning);
    trained("train-actor", conditioning, {"--set", "network.conditioning=" + conditioning});
    CHECK(clips.losses(conditioning) != clips.losses("action_bias"));
    CHECK(run({"generate", "--model", conditioning + "/model", "--action", "walk", "--seconds", "0.8"}, clips.path)
              .code == 0);
  }
}

TEST_CASE("a latent for each frame is trained, generated, denoised and measured") {
  const Clips clips;
  const auto trained = clips.train("train-actor", "frames",
                                   {"--set", "network.encoder=frames", "--set", "network.decoder=frames", "--set",
                                    "network.latent_dim=6", "--set", "network.ff_size=8"});
  REQUIRE_MESSAGE(trained.code == 0, trained.text);
  const auto losses = clips.losses("frames");
  CHECK(mean(std::span(losses).last(losses.size() / 2)) < mean(std::span(losses).first(losses.size() / 2)));
  REQUIRE(clips.train("train-classifier", "judge", {}).code == 0);
  const auto measured = run({"evaluate", "frames/model", "--data", ".", "--labels", "labels.tsv", "--classifier",
                             "judge/model", "--seeds", "2"},
                            clips.path);
  REQUIRE_MESSAGE(measured.code == 0, measured.text);
  CHECK_MESSAGE(contains(measured.text, "  generated"), measured.text);
  const auto made =
      run({"generate", "--model", "frames/model", "--action", "walk", "--seconds", "0.8", "--out", "made"}, clips.path);
  CHECK_MESSAGE(made.code == 0, made.text);
  const auto line = run({"generate", "--model", "frames/model", "--action", "walk", "--towards", "walk", "--seconds",
                         "0.8", "--out", "line"},
                        clips.path);
  CHECK(line.code != 0);
  CHECK_MESSAGE(contains(line.text, "[motionlang.config.102]"), line.text);
  const auto half = clips.train("train-actor", "half", {"--set", "network.decoder=frames"});
  CHECK(half.code == 1);
  CHECK_MESSAGE(contains(half.text, "frames is both of them, or none"), half.text);
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
