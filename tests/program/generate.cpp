// The command generate with a model of ours.
#include <doctest/doctest.h>

#include <algorithm>

#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>

#include "../support/rigs.hpp"
#include "../support/small_model.hpp"
#include "../support/synthetic_motion.hpp"
#include "small_workplace.hpp"

TEST_CASE("a long text is made in parts, and the program says so") {
  const Workplace w;
  const auto text = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all{
        "generate", "--text",      "walk",          "--seconds",     "17", "--model", "model.safetensors", "--out",
        "long",     "--no-smooth", "--no-fix-feet", "--no-fix-floor"};
    all.insert(all.end(), more.begin(), more.end());
    const auto out = w.run(all);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return std::pair(out.text, ml::read_file(w / "long/walk.bvh"));
  };
  const auto [told, parts] = text({});
  CHECK_MESSAGE(contains(told, "'walk': 17 s are made in parts of at most 8 s"), told);
  const auto [untold, whole] = text({"--no-cut-texts"});
  CHECK(!contains(untold, "in parts"));
  CHECK(parts != whole);
  ml::write_file(w / "parts.txt", "walk # 0 # 5.65\nwalk # 5.65 # 11.3\nwalk # 11.3 # 17\n");
  REQUIRE(w.run({"generate", "--timeline", "parts.txt", "--model", "model.safetensors", "--out", "long", "--no-smooth",
                 "--no-fix-feet", "--no-fix-floor"})
              .code == 0);
  CHECK(ml::read_file(w / "long/parts.bvh") == parts);
  CHECK(contains(w.run({"check", "parts.txt"}).text, "3 texts\n"));
  ml::write_file(w / "whole.txt", "walk # 0 # 17\n");
  CHECK(contains(w.run({"check", "whole.txt"}).text, "1 text cut into 3"));
}

TEST_CASE("what a model of ours does not take is refused") {
  const Workplace w;
  const auto bytes = w.run({"generate", "--model", "model.safetensors", "--text", "walk \xFF", "--seconds", "1"});
  CHECK(bytes.code == 2);
  CHECK_MESSAGE(contains(bytes.text, "is not UTF-8"), bytes.text);
  const auto sources =
      w.run({"generate", "--model", "model.safetensors", "--text", "walk", "--seconds", "1", "--statistics", "."});
  CHECK(sources.code == 2);
  CHECK_MESSAGE(
      contains(
          sources.text,
          "[motionlang.config.102] model.safetensors: --text-encoder, --statistics and --tokenizer are for published"),
      sources.text);
  CHECK(w.run({"generate", "--model", "model.safetensors", "--text", "walk", "--drop-animations"}).code == 2);
}

TEST_CASE("weights may ask for a sampler and a number of steps; the command line goes first") {
  const Workplace w;
  auto made = [&](const std::string& out, const std::vector<std::string>& more) {
    const auto done = w.generate(out, more);
    REQUIRE_MESSAGE(done.code == 0, done.text);
    return w.files(out).at("two.bvh");
  };
  const auto full = made("full", {}), ddim = made("ddim", {"--sampler", "ddim", "--steps", "3"});
  auto config = small::config(5);
  config.sampler = ml::SamplingOptions::Sampler::ddim, config.sampling_steps = 3;
  ml::save_stmc(w / "model.safetensors", small::model<B>(config), config, {{"license", "MIT"}});
  CHECK(made("asked", {}) == ddim);
  CHECK(made("asked-full", {"--preset", "full"}) == full);
  CHECK(made("asked-steps", {"--steps", "5"}) == made("full-ddim", {"--sampler", "ddim", "--steps", "0"}));
  CHECK(made("plms", {"--sampler", "plms"}) != ddim);
  CHECK(made("plms-again", {"--sampler", "plms"}) == made("plms-third", {"--sampler", "plms", "--steps", "3"}));
  CHECK(made("asked-sampler", {"--sampler", "ddpm"}) == made("other", {"--sampler", "ddpm", "--steps", "3"}));
}

TEST_CASE("generate writes every output, and the same bytes for the same seed") {
  const Workplace w;
  const auto first = w.generate("a", {"--seed", "4", "--threads", "1"});
  REQUIRE_MESSAGE(first.code == 0, first.text);
  const auto a = w.files("a");
  for (const char* extension : {".bvh", ".glb", ".npz", ".npy", ".svg", ".html"})
    CHECK_MESSAGE(a.contains(std::string("two") + extension), extension);
  CHECK(a.size() == 6);
  CHECK(ml::read_bvh_motion(w / "a/two.bvh").frames() == 20);
  for (const char* command : {"view", "strip"}) CHECK(w.run({command, "a/two.bvh"}).code == 0);
  for (const char* file : {"a/two.bvh.html", "a/two.bvh.svg"}) CHECK_MESSAGE(std::filesystem::remove(w / file), file);
  CHECK(w.files("a") == a);  // the page and the strip with the tracks as well
  CHECK(w.run({"info", "a/two.glb"}).code == 0);
  CHECK(contains(w.run({"info", "a/two.npz"}).text, "20 frames"));
  const auto joints = w.run({"info", "a/two.npy"});
  CHECK_MESSAGE(
      contains(joints.text,
               "joint positions, 20 frames of 24 joints\n  read as Z up and turned to Y up, joints are within x "),
      joints.text);

  CHECK(w.generate("b", {"--seed", "4", "--threads", "2"}).code == 0);
  CHECK(w.files("b") == a);
  CHECK(w.generate("c", {"--seed", "5"}).code == 0);
  CHECK(w.files("c").at("two.bvh") != a.at("two.bvh"));
  for (const char* backend : {"xtensor", "reference"}) {
    CHECK(w.generate(backend, {"--seed", "4", "--backend", backend}).code == 0);
    const auto same = ml::read_bvh_motion(w / (std::string(backend) + "/two.bvh"));
    CHECK(synthetic::largest_distance(same, ml::read_bvh_motion(w / "a/two.bvh")) < 1e-3);
  }
}

TEST_CASE("several timelines and plain texts: a motion each, one page") {
  const Workplace w;
  ml::write_file(w / "list.txt", "walk forward # 0.5\nsit down # 0.4\n");
  const auto out =
      w.generate("out", {"--sampler", "ddim", "--steps", "2", "--guidance", "1", "--overlap", "0"}, "list.txt");
  REQUIRE_MESSAGE(out.code == 0, out.text);
  const auto files = w.files("out");
  CHECK(files.size() == 11);
  CHECK(files.contains("list_0.bvh"));
  CHECK(files.contains("list_1.glb"));
  CHECK(files.contains("list.html"));
}

TEST_CASE("generate --samples: different motions, of which the first is the one without samples; one page") {
  const Workplace w;
  REQUIRE(w.generate("one", {"--seed", "4"}).code == 0);
  const auto made = w.generate("three", {"--seed", "4", "--samples", "3"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  const auto files = w.files("three");
  CHECK(files.size() == 3 * 5 + 1);
  for (const char* file : {"two_1.bvh", "two_2.glb", "two_3.svg", "two_3.npz", "two.html"})
    CHECK_MESSAGE(files.contains(file), file);
  for (const char* name : {"\"two_1\"", "\"two_2\"", "\"two_3\""})
    CHECK_MESSAGE(contains(files.at("two.html"), name), name);
  const auto sample = [&](const std::string& file) { return ml::read_bvh_motion(w / file); };
  CHECK(synthetic::largest_distance(sample("three/two_1.bvh"), sample("one/two.bvh")) < 1e-3);
  CHECK(synthetic::largest_distance(sample("three/two_1.bvh"), sample("three/two_2.bvh")) > 1e-3);
  CHECK(synthetic::largest_distance(sample("three/two_2.bvh"), sample("three/two_3.bvh")) > 1e-3);

  ml::write_file(w / "list.txt", "walk forward # 0.5\nsit down # 0.4\n");
  REQUIRE(w.generate("list", {}, "list.txt").code == 0);
  REQUIRE(w.generate("lists", {"--samples", "2"}, "list.txt").code == 0);
  CHECK(w.files("lists").size() == 4 * 5 + 1);
  for (const std::string timeline : {"list_0", "list_1"}) {
    const auto alone = sample("list/" + timeline + ".bvh"), first = sample("lists/" + timeline + "_1.bvh"),
               second = sample("lists/" + timeline + "_2.bvh");
    CHECK(synthetic::largest_distance(first, alone) < 1e-3);
    CHECK(second.frames() == first.frames());
    CHECK(synthetic::largest_distance(second, first) > 1e-3);
  }
  CHECK(w.generate("none", {"--samples", "0"}).code == 2);
}

TEST_CASE("generate does not write over what it keeps") {
  const Workplace w;
  std::filesystem::create_directories(w / "out");
  ml::write_bvh(w / "out/two.bvh", synthetic::walk({.frames = 40}));
  const std::string before = ml::read_file(w / "out/two.bvh");
  const Outcome over = w.generate("out", {"--keep", "out/two.bvh", "--keep-parts", "legs"});
  CHECK(over.code == 2);
  CHECK_MESSAGE(contains(over.text, "out/two.bvh is an input"), over.text);
  CHECK(ml::read_file(w / "out/two.bvh") == before);
}

TEST_CASE("generate --keep: frames and body parts of a motion stay, in their place") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40, .turn = 0.5}));
  const auto walk = ml::read_bvh_motion(w / "walk.bvh");
  const std::vector<std::string> as_made{"--keep", "walk.bvh", "--no-smooth", "--no-fix-feet", "--no-fix-floor"};
  const auto keeping = [&](const std::string& out, std::vector<std::string> what) {
    what.insert(what.end(), as_made.begin(), as_made.end());
    const Outcome made = w.generate(out, what);
    REQUIRE_MESSAGE(made.code == 0, made.text);
    return ml::read_bvh_motion(w / (out + "/two.bvh"));
  };
  const auto turn = [&](const ml::Motion& m, ml::Index frame, const char* joint) {
    return ml::distance(m.rotations(frame)[static_cast<std::size_t>(m.skeleton[joint])],
                        walk.rotations(frame)[static_cast<std::size_t>(walk.skeleton[joint])]);
  };
  const ml::Motion begun = keeping("begun", {"--keep-seconds", "0-0.25,0.8-1"}),
                   steps = keeping("steps", {"--keep-parts", "legs"});
  REQUIRE((begun.frames() == 20 && steps.frames() == 20));
  for (const ml::Index f : {0, 4, 10, 17}) {
    CAPTURE(f);
    const bool kept = f != 10;
    for (const char* joint : {"left_knee", "right_shoulder", "spine3"}) CHECK((turn(begun, f, joint) < 1e-3) == kept);
    CHECK(turn(steps, f, "left_knee") < 1e-3);
    CHECK(turn(steps, f, "right_shoulder") > 1e-2);
    const auto apart = steps.root_at(f) - walk.root_at(f);
    CHECK(std::hypot(apart.x, apart.z) < 1e-3);
  }
  // in whatever order, with spaces
  CHECK(synthetic::largest_distance(keeping("again", {"--keep-seconds", "0.8-1, 0-0.25"}), begun) < 1e-3);
  // a T-pose that was put in front is not part of it
  ml::Motion pose = ml::crop(walk, 0, 1);
  std::fill(pose.local.begin(), pose.local.end(), ml::Quaternion<double>::identity());
  ml::write_bvh(w / "exported.bvh", ml::concatenate(pose, walk));
  const Outcome performed = w.generate("performed", {"--keep", "exported.bvh", "--keep-seconds", "0-0.25,0.8-1",
                                                     "--no-smooth", "--no-fix-feet", "--no-fix-floor"});
  CHECK_MESSAGE(contains(performed.text, "exported.bvh: left out: 1 frame of an inserted T-pose"), performed.text);
  CHECK(synthetic::largest_distance(ml::read_bvh_motion(w / "performed/two.bvh"), begun) < 1e-3);
  // the way comes to another place, and the program says so
  const auto apart = begun.root_at(16) - walk.root_at(16);
  REQUIRE(std::hypot(apart.x, apart.z) > 0.1);
  CHECK_MESSAGE(contains(performed.text, "--keep: kept frames are up to "), performed.text);
  // what is made goes on where what is kept ends, and comes to where it begins again
  REQUIRE(
      w.generate("fitted", {"--keep", "walk.bvh", "--keep-seconds", "0-0.25,0.8-1", "--no-fix-feet", "--no-fix-floor"})
          .code == 0);
  const ml::Motion fitted = ml::read_bvh_motion(w / "fitted/two.bvh");
  const auto largest_step = [](const ml::Motion& m, ml::Index frame) {
    double out = 0;
    for (std::size_t j = 1; j < m.rotations(frame).size(); ++j)
      out = std::max(out, ml::distance(m.rotations(frame - 1)[j], m.rotations(frame)[j]));
    return out;
  };
  for (const ml::Index f : {5, 16}) CHECK(largest_step(fitted, f) < 0.7 * largest_step(begun, f));
  // how far kept frames are from where they were is measured when feet are fixed, at the farthest of them
  const Outcome steady = w.generate("steady", {"--keep", "walk.bvh", "--keep-seconds", "0-0.25,0.8-1"});
  const ml::Motion fixed = ml::read_bvh_motion(w / "steady/two.bvh");
  double farthest = 0;
  for (const ml::Index f : {0, 1, 2, 3, 4, 16, 17, 18, 19}) {
    const auto d = fixed.root_at(f) - walk.root_at(f);
    farthest = std::max(farthest, std::hypot(d.x, d.z));
  }
  const auto said_of = [](const Outcome& out) {
    const std::string up_to = "kept frames are up to ";
    REQUIRE_MESSAGE(contains(out.text, up_to), out.text);
    return std::stod(out.text.substr(out.text.find(up_to) + up_to.size()));
  };
  CHECK((said_of(steady) > farthest - 1e-4 && said_of(steady) < farthest + 0.011));
  CHECK(std::abs(said_of(performed) - said_of(steady)) > 0.02);  // as it was before feet were fixed
  CHECK(turn(begun, 0, "pelvis") < 1e-3);
  CHECK(std::hypot(begun.root_at(4).x - walk.root_at(4).x, begun.root_at(4).z - walk.root_at(4).z) < 1e-3);

  const auto refused = [&](const std::vector<std::string>& what, const char* text) {
    auto all = what;
    all.insert(all.end(), {"--keep", "walk.bvh"});
    const Outcome o = w.generate("no", all);
    CHECK_MESSAGE((o.code == 2 && contains(o.text, text)), o.text);
  };
  refused({}, "needs --keep-seconds or --keep-parts");
  refused({"--keep-parts", "tail"}, "--keep-parts: 'tail' is not one of left arm");
  refused({"--keep-seconds", "3-1"}, "'3-1' is not a time range like 0-1.5");
  for (const char* none : {"-1", "-1-1", "1-", "1", "-", "nan-1", "0-inf", "0-1x"})
    refused({std::string("--keep-seconds=") + none}, "is not a time range like 0-1.5");
  refused({"--keep-seconds", "0-1.5"},
          "0-1.5 is frames 0:30 at 20 per second; the motion to keep has 40, the timeline 20");
  refused({"--keep-seconds", "0.5-0.51"}, "0.5-0.51 is frames 10:10 at 20 per second");
  refused({"--keep-parts", "legs", "--record"}, "--record");
}

TEST_CASE("a diffusion model has no latents: it does not go from text to text, and does not denoise a motion") {
  const Workplace w;
  const std::string is =
      " is for models with one latent for every motion (ACTOR, TEMOS, TMR, SINC); this is a diffusion model";
  const auto towards = w.run({"generate", "--text", "walk", "--towards", "run", "--model", "model.safetensors"});
  CHECK(towards.code == 2);
  CHECK_MESSAGE(contains(towards.text, "[motionlang.config.102] model.safetensors: --towards" + is), towards.text);
  CHECK(w.generate("out", {"--towards", "run"}).code == 2);
  CHECK(w.files("out").empty());

  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const auto denoise = w.run({"convert", "walk.bvh", "clean.bvh", "--denoise", "model.safetensors"});
  CHECK(denoise.code == 2);
  CHECK_MESSAGE(contains(denoise.text, "[motionlang.config.102] model.safetensors: --denoise" + is), denoise.text);
  CHECK(!std::filesystem::exists(w / "clean.bvh"));
}

TEST_CASE("noise from outside gives the motion of the seed that it was drawn with") {
  const Workplace w;
  const auto model = ml::load_stmc<B>((w / "model.safetensors").string());
  ml::TensorStore store;
  const ml::Shape shape{1, 20, 205};
  for (int draw = 0; draw <= 5; ++draw) {
    const auto z = model.noise({.seed = 4}, draw, shape);
    store.add<float>("noise/00" + std::to_string(draw), shape, z.span(), ml::DType::F32);
  }
  ml::write_safetensors(w / "noise.safetensors", store.views());
  CHECK(w.generate("seed", {"--seed", "4"}).code == 0);
  const auto noise = w.generate("noise", {"--noise", "noise.safetensors"});
  REQUIRE_MESSAGE(noise.code == 0, noise.text);
  for (const char* file : {"two.bvh", "two.glb", "two.npz", "two.npy"})
    CHECK_MESSAGE(w.files("noise").at(file) == w.files("seed").at(file), file);
  CHECK(contains(w.files("seed").at("two.html"), "seed 4, model model"));
  CHECK(contains(w.files("noise").at("two.html"), "noise noise.safetensors, model model"));

  const auto both = w.generate("both", {"--noise", "noise.safetensors", "--seed", "4"});
  CHECK(both.code != 0);
  CHECK_MESSAGE(contains(both.text, "--seed excludes --noise"), both.text);
  ml::write_file(w / "longer.txt", "walk forward # 0 # 2 # legs\n");
  const auto wrong = w.generate("wrong", {"--noise", "noise.safetensors"}, "longer.txt");
  CHECK(wrong.code == 1);
  CHECK_MESSAGE(contains(wrong.text, "noise/000 is (1, 20, 205), this timeline needs (1, 40, 205)"), wrong.text);
}

TEST_CASE("feet are put right unless that is switched off") {
  const Workplace w;
  CHECK(w.generate("on", {"--seed", "4", "--no-fix-floor"}).code == 0);
  CHECK(w.generate("off", {"--seed", "4", "--no-fix-feet", "--no-fix-floor"}).code == 0);
  const auto on = ml::read_amass(w / "on/two.npz").motion, off = ml::read_amass(w / "off/two.npz").motion;
  CHECK(synthetic::largest_distance(on, ml::fix_feet(off)) < 1e-3);
}

TEST_CASE("trembling is taken away, and then feet are put right, unless that is switched off") {
  const Workplace w;
  CHECK(w.generate("on", {"--seed", "4", "--no-fix-floor"}).code == 0);
  CHECK(w.generate("own", {"--seed", "4", "--no-fix-feet", "--no-fix-floor", "--no-smooth"}).code == 0);
  const auto on = ml::read_amass(w / "on/two.npz").motion, own = ml::read_amass(w / "own/two.npz").motion;
  CHECK(synthetic::largest_distance(on, ml::fix_feet(ml::smooth_motion(own))) < 1e-3);
  CHECK(synthetic::largest_distance(on, ml::fix_feet(own)) > 1e-3);
}

TEST_CASE("convert and generate put motions on a character") {
  const Workplace w;
  ml::write_file(w / "rig.glb", rigs::glb_of(rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:")));
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const auto out = w.run({"convert", "walk.bvh", "walk.glb", "--rig", "rig.glb"});
  REQUIRE_MESSAGE(out.code == 0, out.text);
  CHECK_MESSAGE(contains(out.text, "SMPL -> Mixamo: 24 of"), out.text);
  CHECK(ml::GlbFile::open(w / "walk.glb").animation_names() == std::vector<std::string>{"idle", "walk"});
  const auto alone = w.run({"convert", "walk.glb", "alone.glb", "--rig", "rig.glb", "--drop-animations"});
  REQUIRE_MESSAGE(alone.code == 0, alone.text);
  CHECK_MESSAGE(contains(alone.text, "all joints follow"), alone.text);  // it is on the character's skeleton now
  CHECK(ml::GlbFile::open(w / "alone.glb").animation_names() == std::vector<std::string>{"idle", "walk"});
  CHECK(contains(w.run({"convert", "walk.bvh", "walk.npz", "--rig", "rig.glb"}).text,
                 "is written to .glb and .html, not '.npz'"));
  CHECK(!std::filesystem::exists(w / "walk.npz"));
  const auto page = w.run({"view", "walk.bvh", "page.html", "--rig", "rig.glb"});
  REQUIRE_MESSAGE(page.code == 0, page.text);
  CHECK_MESSAGE(contains(page.text, "page.html on rig.glb\nSMPL -> Mixamo: 24 of"), page.text);
  REQUIRE(w.run({"convert", "walk.bvh", "same.html", "--rig", "rig.glb"}).code == 0);
  CHECK(w.files(".").at("same.html") == w.files(".").at("page.html"));

  // The same as .gltf, whose data are in it: as the character, and as the motion.
  ml::write_file(w / "rig.gltf", rigs::gltf_of(ml::MappedFile::open(w / "rig.glb")->bytes()));
  REQUIRE(w.run({"convert", "walk.bvh", "same.glb", "--rig", "rig.gltf"}).code == 0);
  CHECK(w.files(".").at("same.glb") == w.files(".").at("walk.glb"));
  REQUIRE(w.run({"convert", "rig.gltf", "idle.bvh"}).code == 0);
  REQUIRE(w.run({"convert", "rig.glb", "idle2.bvh"}).code == 0);
  CHECK(ml::read_file(w / "idle.bvh") == ml::read_file(w / "idle2.bvh"));

  const auto made = w.generate("out", {"--rig", "rig.glb"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  CHECK(ml::GlbFile::open(w / "out/two.glb").animation_names() == std::vector<std::string>{"idle", "two"});
}
