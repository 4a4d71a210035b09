// The commands train-mdm-smpl, train-mdm, train-motiondiffuse and train-mdm-actions on a few made-up clips: trained,
// extended, generated with, evaluated.
#include <doctest/doctest.h>

#include <map>

#include <motionlang/file/id_list.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/weights/embedding_cache.hpp>

#include "../support/official_folders.hpp"
#include "training_clips.hpp"

namespace {

struct DiffusionClips : Clips {
  /// Tiny networks, four diffusion steps, two epochs.
  Outcome train_tiny(const std::string& command, const std::string& out, std::vector<std::string> more = {}) const {
    const bool texts = command != "train-mdm-actions";
    std::vector<std::string> arguments{command, "--data", ".", "--out", out, "--preset", "small"};
    if (texts)
      arguments.insert(arguments.end(), {"--captions", "captions.tsv"});
    else
      arguments.insert(arguments.end(), {"--labels", "labels.tsv"});
    const auto set = [&](const std::string& assignment) { arguments.insert(arguments.end(), {"--set", assignment}); };
    for (const char* a : {"data.min_seconds=0.5", "data.test_share=0.25", "data.validation_share=0.25",
                          "optimiser.batch=2", "optimiser.epochs=2", "validation.every=1", "network.latent_dim=8",
                          "network.ff_size=8", "network.num_layers=1", "network.num_heads=2", "diffusion.steps=4"})
      set(a);
    if (texts) {
      for (const char* a : {"data.mirror=false", "text.width=8", "text.ff_size=8", "text.num_layers=1",
                            "text.num_heads=2", "text.vocabulary=40"})
        set(a);
    } else {
      set("clips.num_frames=12");
    }
    if (command == "train-motiondiffuse") {
      // its linear schedule needs more than twenty steps
      for (const char* a :
           {"diffusion.steps=24", "network.text_latent_dim=8", "network.text_ff_size=8", "network.text_num_heads=2"})
        set(a);
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, path);
  }
};

}  // namespace

TEST_CASE("MDM-SMPL, MDM and MotionDiffuse: train, generate from texts and timelines, evaluate") {
  const DiffusionClips clips;
  ml::write_file(clips / "two.txt",
                 std::string_view("a person walks # 0 # 2 # legs\nsomeone turns # 0.5 # 1.5 # spine\n"));
  ml::write_file(
      clips / "texts.txt",
      std::string_view("walk forward # legs\nsit down # legs # spine\nraise both arms # left arm # right arm\n"
                       "wave the right hand # right arm\n"));
  for (const auto& [command, system] : {std::pair<std::string, std::string>{"train-mdm-smpl", "stmc"},
                                        {"train-mdm", "mdm"},
                                        {"train-motiondiffuse", "motiondiffuse"}}) {
    CAPTURE(command);
    const Outcome trained = clips.train_tiny(command, system);
    REQUIRE_MESSAGE(trained.code == 0, trained.text);
    CHECK_MESSAGE(contains(trained.text, "motions to train on"), trained.text);
    CHECK(std::filesystem::exists(clips / (system + "/loss.svg")));
    const auto about = ml::read_model_folder(ml::FilePath(clips / (system + "/model")));
    CHECK(about.system == system);
    CHECK(about.others["training"]["network"]["latent_dim"] == 8);

    const std::string model = system + "/model";
    for (const char* what : {"--text", "--timeline"}) {
      const bool text = std::string(what) == "--text";
      std::vector<std::string> arguments{"generate", "--model",    model, what, text ? "a person walks" : "two.txt",
                                         "--out",    system + what};
      if (text) arguments.insert(arguments.end(), {"--seconds", "2"});
      const Outcome made = run(arguments, clips.path);
      REQUIRE_MESSAGE(made.code == 0, made.text);
    }
    const Outcome measured =
        run({"evaluate", model, "--texts", "texts.txt", "--first", "1", "--modes", "stmc", "--steps", "2"}, clips.path);
    REQUIRE_MESSAGE(measured.code == 0, measured.text);
    CHECK_MESSAGE(contains(measured.text, "\n  STMC "), measured.text);
    const Outcome info = run({"info", model}, clips.path);
    CHECK_MESSAGE(contains(info.text, system), info.text);
  }
  const Outcome judged = run({"judge", "--model", "stmc/model", "--seeds", "1", "--steps", "2"}, clips.path);
  CHECK_MESSAGE(judged.code == 0, judged.text);
}

TEST_CASE("a training that is extended goes on with the same numbers") {
  const DiffusionClips clips;
  for (const std::string command : {"train-mdm-smpl", "train-mdm", "train-motiondiffuse", "train-mdm-actions"}) {
    CAPTURE(command);
    const std::string whole = command + "_whole", halves = command + "_halves";
    const auto train = [&](const std::string& out, const std::string& epochs, std::vector<std::string> more = {}) {
      more.insert(more.end(), {"--set", "optimiser.schedule=constant", "--set", "optimiser.epochs=" + epochs});
      return clips.train_tiny(command, out, std::move(more));
    };
    REQUIRE(train(whole, "2").code == 0);
    REQUIRE(train(halves, "1").code == 0);
    const Outcome rest = train(halves, "2", {"--recompute"});
    REQUIRE_MESSAGE(rest.code == 0, rest.text);
    CHECK_MESSAGE(contains(rest.text, "continuing at step 2 of 4"), rest.text);
    CHECK(clips.losses(halves) == clips.losses(whole));
    CHECK(clips.weights(halves) == clips.weights(whole));
    const Outcome other = train(halves, "3", {"--set", "diffusion.steps=30"});
    CHECK_MESSAGE((other.code == 1 && contains(other.text, "[motionlang.config.102]")), other.text);
  }
}

TEST_CASE("texts as vectors of a cache, and of a DistilBERT for the decoder of MDM") {
  const DiffusionClips clips;
  ml::EmbeddingCache cache(4);
  for (const char* text : {"", "a person turns left", "someone turns", "a person walks ahead", "someone walks"}) {
    const float first = static_cast<float>(std::string_view(text).size());
    cache.add(text, std::vector<float>{first, 1, -first, 0.5f});
  }
  cache.write(clips.path, "clip");
  const std::vector<std::string> clip{"--set", "text.encoder=clip", "--text-encoder", "clip.npy"};
  for (const char* command : {"train-mdm-smpl", "train-mdm"}) {
    const Outcome trained = clips.train_tiny(command, command, clip);
    REQUIRE_MESSAGE(trained.code == 0, trained.text);
  }
  const Outcome ends = clips.train_tiny("train-motiondiffuse", "no", clip);
  CHECK_MESSAGE((ends.code == 2 && contains(ends.text, "a cache does not say where texts end")), ends.text);
  const Outcome needed = clips.train_tiny("train-mdm", "no", {"--set", "text.encoder=clip"});
  CHECK_MESSAGE((needed.code == 2 && contains(needed.text, "text.encoder = clip needs --text-encoder")), needed.text);

  write_distilbert(clips / "distilbert");
  const Outcome bert = clips.train_tiny(
      "train-mdm", "bert",
      {"--set", "text.encoder=distilbert", "--set", "network.arch=trans_dec", "--text-encoder", "distilbert"});
  REQUIRE_MESSAGE(bert.code == 0, bert.text);
  const Outcome made = run({"generate", "--model", "bert/model", "--text-encoder", "distilbert", "--text",
                            "a person walks ahead", "--seconds", "2", "--out", "made"},
                           clips.path);
  CHECK_MESSAGE(made.code == 0, made.text);
  // OpenAI's two files of CLIP, as the papers have it
  official::write_clip(clips / "CLIP", official::small());
  for (const char* command : {"train-mdm-smpl", "train-mdm", "train-motiondiffuse"}) {
    CAPTURE(command);
    const Outcome by_clip =
        clips.train_tiny(command, "by_clip", {"--set", "text.encoder=clip", "--text-encoder", "CLIP", "--fresh"});
    REQUIRE_MESSAGE(by_clip.code == 0, by_clip.text);
    const Outcome said = run({"generate", "--model", "by_clip/model", "--text-encoder", "CLIP", "--text", "walk",
                              "--seconds", "2", "--out", "made"},
                             clips.path);
    CHECK_MESSAGE(said.code == 0, said.text);
  }
  const Outcome wrong = clips.train_tiny("train-mdm", "no", {"--set", "text.encoder=distilbert"});
  CHECK_MESSAGE((wrong.code == 2 && contains(wrong.text, "network.arch = trans_dec")), wrong.text);
}

TEST_CASE("data sets in the form of HumanML3D, and STMC's own features by annotations") {
  const DiffusionClips clips;
  const std::string folder = (clips / "h3d").string();
  for (const char* id : {"000000", "000001", "000002"}) add_walk(folder, id, 60, "guoh3d", ml::humanml3d_form);
  ml::write_ids(folder + "/train.txt", std::vector<std::string>{"000000", "000001"});
  ml::write_ids(folder + "/test.txt", std::vector<std::string>{"000002"});
  const std::vector<float> mean(263), deviation(263, 2);
  ml::write_npy(clips / "h3d/Mean.npy", ml::NpyArray::of(std::span<const float>(mean), {263}));
  ml::write_npy(clips / "h3d/Std.npy", ml::NpyArray::of(std::span<const float>(deviation), {263}));
  const auto train = [&](const std::string& command, std::vector<std::string> more) {
    std::vector<std::string> arguments{command, "--preset", "small", "--out", "out", "--fresh"};
    for (const char* a : {"optimiser.epochs=1", "optimiser.batch=2", "network.latent_dim=8", "network.ff_size=8",
                          "network.num_layers=1", "network.num_heads=2", "text.width=8", "text.num_heads=2"})
      arguments.insert(arguments.end(), {"--set", a});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, clips.path);
  };
  const Outcome h3d = train("train-mdm", {"--data", "h3d"});
  REQUIRE_MESSAGE(h3d.code == 0, h3d.text);
  CHECK_MESSAGE(contains(h3d.text, "mean and deviation of h3d/Mean.npy"), h3d.text);
  const auto weights = ml::SafetensorsFile::open(clips / "out/model/weights.safetensors");
  CHECK(ml::values_of<float>(weights.tensor("motion_normalizer.std")) == deviation);

  // Ready-made rows of 205 numbers; HumanAct12 is left out.
  std::filesystem::create_directories(clips / "amass/KIT");
  auto rng = ml::Philox{.seed = 1};
  std::vector<float> rows(60 * 205);
  rng.normal(std::span<float>(rows));
  ml::write_npy(clips / "amass/KIT/walk.npy", ml::NpyArray::of(std::span<const float>(rows), {60, 205}));
  ml::write_file(clips / "annotations.json", std::string_view(R"({
    "00000": {"path": "KIT/walk", "duration": 3, "annotations": [
      {"seg_id": "00000_0", "text": "a person walks", "start": 0.0, "end": 2.5}]},
    "00001": {"path": "humanact12/humanact12/P01G01", "duration": 3, "annotations": [
      {"seg_id": "00001_0", "text": "a person turns", "start": 0.0, "end": 3.0}]}})"));
  const Outcome stmc = train("train-mdm-smpl", {"--data", "amass", "--annotations", "annotations.json", "--set",
                                                "data.test_share=0", "--set", "data.validation_share=0"});
  REQUIRE_MESSAGE(stmc.code == 0, stmc.text);
  CHECK_MESSAGE(contains(stmc.text, "1 motion to train on, 0 for validation, 0 for tests; 1 left out"), stmc.text);
}

TEST_CASE("MDM of actions: train, and generate an action") {
  const DiffusionClips clips;
  const Outcome trained = clips.train_tiny("train-mdm-actions", "actions");
  REQUIRE_MESSAGE(trained.code == 0, trained.text);
  CHECK(clips.terms("actions") == std::vector<std::string>{"rot_mse", "rcxyz_mse", "vel_mse", "fc"});
  const Outcome made = run(
      {"generate", "--model", "actions/model", "--action", "turn", "--seconds", "0.8", "--out", "made"}, clips.path);
  REQUIRE_MESSAGE(made.code == 0, made.text);
  CHECK(std::filesystem::exists(clips / "made/turn.bvh"));
  const Outcome longer =
      run({"generate", "--model", "actions/model", "--action", "walk", "--seconds", "5", "--out", "no"}, clips.path);
  CHECK(longer.code != 0);
  const Outcome unknown = run({"generate", "--model", "actions/model", "--action", "fly", "--out", "no"}, clips.path);
  CHECK(unknown.code != 0);
  const Outcome refused = clips.train_tiny("train-mdm-actions", "no", {"--set", "clips.camera=false"});
  CHECK_MESSAGE((refused.code == 2 && contains(refused.text, "clips.camera = true")), refused.text);
}

TEST_CASE("the preset bundled is what train does, with every setting by its name") {
  const DiffusionClips clips;
  using Words = std::vector<std::string>;
  const Words data{"--data", ".", "--captions", "captions.tsv"};
  const auto joined = [](Words first, const Words& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
  };
  const auto bundled = [&](const std::string& out, const Words& more) {
    return run(joined({"train-mdm-smpl", "--preset", "bundled", "--out", out}, more), clips.path);
  };
  const auto tiny = [&](const Words& settings) {  // with data
    Words out = data;
    for (const char* size :
         {"network.latent_dim=16", "network.ff_size=24", "network.num_layers=1", "vocabulary=40", "optimiser.batch=2"})
      out = joined(out, {"--set", size});
    for (const std::string& setting : settings) out = joined(out, {"--set", setting});
    return out;
  };
  const Outcome named = run(joined({"train", "--out=named", "--steps=3", "--batch=2", "--lr=1e-3", "--width=16",
                                    "--feed-forward=24", "--layers=1", "--vocabulary=40", "--text-steps=2",
                                    "--foot-weight=0.5", "--practise=walks", "--practice=2"},
                                   data),
                            clips.path);
  REQUIRE_MESSAGE(named.code == 0, named.text);
  const Words settings{"updates=3",       "optimiser.lr=1e-3",     "text_steps=2",
                       "losses.foot=0.5", "practised=[\"walks\"]", "practice=2"};
  const Outcome preset = bundled("preset", joined(tiny(settings), {"--license", "MIT"}));
  REQUIRE_MESSAGE(preset.code == 0, preset.text);
  CHECK(!clips.losses("preset").empty());
  CHECK(clips.losses("preset") == clips.losses("named"));
  const auto a = ml::SafetensorsFile::open(clips / "named/stmc.safetensors"),
             b = ml::SafetensorsFile::open(clips / "preset/stmc.safetensors");
  CHECK(b.metadata().at("license") == "MIT");
  REQUIRE(a.tensors().size() == b.tensors().size());
  for (const auto& t : a.tensors())
    CHECK_MESSAGE(ml::values_of<float>(t) == ml::values_of<float>(b.tensor(t.name)), t.name);

  const Outcome started = bundled("started", joined(tiny({"updates=2"}), {"--start", "preset/stmc.safetensors"}));
  REQUIRE_MESSAGE(started.code == 0, started.text);
  CHECK(started.text.find("learning texts") == std::string::npos);
  const Outcome made = run({"generate", "--model", "started/stmc.safetensors", "--text", "a person walks", "--seconds",
                            "2", "--out", "made"},
                           clips.path);
  CHECK_MESSAGE(made.code == 0, made.text);

  // without an average the weights themselves are exported; without updates the epochs decide: 8 segments, batches of 2
  const Outcome plain = bundled("plain", tiny({"updates=0", "optimiser.epochs=1", "optimiser.ema=0", "text_steps=0"}));
  REQUIRE_MESSAGE(plain.code == 0, plain.text);
  CHECK(clips.losses("plain").size() == 4);
  const auto exported = ml::values_of<float>(
      ml::SafetensorsFile::open(clips / "plain/stmc.safetensors").tensor("denoiser.to_skel_layer.bias"));
  auto trained = ml::values_of<float>(clips.checkpoint("plain").tensor("model.denoiser.to_skel_layer.bias"));
  REQUIRE(exported.size() == trained.size());
  for (std::size_t i = 0; i < trained.size(); ++i) CHECK(exported[i] == doctest::Approx(trained[i]).epsilon(1e-3));

  // a run that goes on must practise the same words
  std::vector<std::string> fewer(settings.begin(), settings.end());
  fewer[4] = "practised=[\"walks\",\"turns\"]";
  const Outcome practises = bundled("preset", tiny(fewer));
  CHECK_MESSAGE((practises.code == 1 && contains(practises.text, "another training.practised")), practises.text);

  const Outcome printed = bundled("no", {"--print-config"});
  CHECK_MESSAGE(contains(printed.text, "\"snr_cap\": 10.0"), printed.text);
  for (const auto& [more, message] : std::vector<std::pair<Words, std::string>>{
           {{"--data", "."}, "--preset bundled needs --captions"},
           {joined(data, {"--splits", "."}), "--splits is not for --preset bundled"},
           {tiny({"losses.snr_cap=0"}), "losses: snr_cap is 0"},
           {tiny({"samples.speed=1"}), "samples: speed is 1"},
           {tiny({"sampling.steps=101"}), "sampling.steps = 101, diffusion.steps = 100"},
           {tiny({"practice=2"}), "practice = 2, and practised names no words"},
           {tiny({"text.heads=0"}), "text: heads is 0"},
           {tiny({"text.width=9"}), "text.width = 9 is odd or no multiple of 4 heads"},
           {tiny({"pose_scale=0"}), "pose_scale is 0"},
           {tiny({"diffusion.schedule=chen"}), "that of the bundled model is cosine"},
           {tiny({"learning_rate=1"}), "learning_rate"}}) {
    const Outcome refused = bundled("no", more);
    CHECK_MESSAGE((refused.code != 0 && contains(refused.text, message)), refused.text);
  }
  const Outcome unknown = run({"train-mdm-smpl", "--preset", "bundle", "--print-config"}, clips.path);
  CHECK_MESSAGE((unknown.code == 2 && contains(unknown.text, "small, bundled")), unknown.text);
  const Outcome other = clips.train_tiny("train-mdm-smpl", "no", {"--start", "preset/stmc.safetensors"});
  CHECK_MESSAGE((other.code == 2 && contains(other.text, "--start is for --preset bundled")), other.text);
  CHECK_FALSE(std::filesystem::exists(clips / "no"));
}
