// The command convert.
#include <doctest/doctest.h>

#include <algorithm>

#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/formats/motion_npy.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/one_euro_filter.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>

#include "../support/mdm_results.hpp"
#include "../support/octahedra_body.hpp"
#include "../support/rigs.hpp"
#include "../support/synthetic_motion.hpp"
#include "small_workplace.hpp"

TEST_CASE("convert says what is strange about a motion: a T-pose in front, a doll") {
  const Workplace w;
  const ml::Motion walk = synthetic::walk({.frames = 40});
  ml::Motion pose = ml::crop(walk, 0, 1);
  std::fill(pose.local.begin(), pose.local.end(), ml::Quaternion<double>::identity());
  ml::write_bvh(w / "posed.bvh", ml::concatenate(pose, walk));
  const auto posed = w.run({"convert", "posed.bvh", "x.glb"});
  CHECK_MESSAGE(
      contains(posed.text, "posed.bvh: begins with 1 frame of a T-pose in front of the recording; --from 0.05 leaves"),
      posed.text);
  CHECK(!contains(w.run({"convert", "posed.bvh", "x.bvh", "--from", "0.05"}).text, "T-pose"));
  CHECK(!contains(w.run({"convert", "x.bvh", "x.glb"}).text, "T-pose"));
  CHECK(!contains(w.run({"convert", "x.bvh", "x.glb"}).text, " large"));
  const auto doll = w.run({"convert", "x.bvh", "x.glb", "--scale", "0.001"});
  CHECK_MESSAGE((doll.code == 0 && contains(doll.text, "x.bvh: the figure is 0.1")), doll.text);
}

TEST_CASE("an array of positions is written on SMPL's joints, in whatever order the motion has them") {
  const Workplace w;
  const ml::Motion walk = synthetic::walk({.frames = 10});
  ml::write_bvh(w / "deep.bvh", walk);  // depth first
  REQUIRE(w.run({"convert", "deep.bvh", "deep.npy"}).code == 0);
  const auto found = ml::read_joints_npy(w / "deep.npy").positions, wanted = walk.positions();
  REQUIRE(found.size() == wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) CHECK(ml::norm(found[i] - wanted[i]) < 1e-5);
}

TEST_CASE("weights are stored in another type; what the file says of the model stays") {
  const Workplace w;
  CHECK(w.run({"convert", "model.safetensors", "wide.safetensors", "--store", "F32"}).code == 0);
  const auto half = w.run({"convert", "wide.safetensors", "half.safetensors", "--store", "bf16"});
  CHECK_MESSAGE(half.code == 0, half.text);
  CHECK(contains(half.text, "60 tensors"));
  const auto about = w.run({"info", "half.safetensors"});
  for (const char* word : {"BF16", "license", "MIT"})
    CHECK_MESSAGE(contains(about.text, word), word, " in ", about.text);
  const auto size = [&](const char* file) { return std::filesystem::file_size(w / file); };
  CHECK(size("wide.safetensors") > 3 * size("half.safetensors") / 2);
  CHECK(ml::load_stmc<B>((w / "half.safetensors").string()).fps ==
        ml::load_stmc<B>((w / "model.safetensors").string()).fps);
  const auto motion = w.run({"convert", "model.safetensors", "motion.bvh", "--store", "F16"});
  CHECK(motion.code != 0);
  CHECK_MESSAGE(contains(motion.text, "--store: is for weights"), motion.text);
  CHECK(contains(w.run({"convert", "model.safetensors", "m.safetensors", "--mirror"}).text,
                 "--mirror: is not for weights"));
}

TEST_CASE("convert, strip: whole folders, and the files that fail are reported") {
  const Workplace w;
  const auto walk = synthetic::walk({.frames = 40});
  std::filesystem::create_directories(w / "in/a/b");
  ml::write_bvh(w / "in/walk.bvh", walk);
  ml::write_bvh(w / "in/a/walk.bvh", walk);
  REQUIRE(w.run({"convert", "in/walk.bvh", "in/a/walk.npz"}).code == 0);  // the same name beside it
  REQUIRE(w.run({"convert", "in/walk.bvh", "in/a/b/walk.glb"}).code == 0);
  const auto out = w.run({"convert", "in", "out", "--as", ".bvh", "--mirror"});
  CHECK_MESSAGE(out.code == 0, out.text);
  CHECK_MESSAGE(contains(out.text, "out: 4 of 4 files converted"), out.text);
  const auto expected = ml::mirror(ml::read_bvh_motion(w / "in/walk.bvh"));
  for (const std::string name : {"out/walk.bvh", "out/a/walk.bvh"})
    CHECK_MESSAGE(synthetic::largest_distance(ml::read_bvh_motion(w / name), expected) < 1e-3, name);
  for (const char* name : {"out/a/walk_2.bvh", "out/a/b/walk.bvh"}) CHECK(std::filesystem::exists(w / name));

  ml::write_file(w / "in/broken.bvh", std::string_view("HIERARCHY\nROOT"));
  const auto some = w.run({"convert", "in", "strips", "--as", ".svg"});
  CHECK(some.code == 1);
  CHECK_MESSAGE(contains(some.text, "in/broken.bvh: [motionlang."), some.text);
  CHECK_MESSAGE(contains(some.text, "strips: 4 of 5 files converted"), some.text);
  std::filesystem::remove(w / "in/broken.bvh");
  CHECK(contains(w.run({"strip", "in"}).text, "in: 4 of 4 files converted"));
  for (const char* strip : {"in/walk.bvh.svg", "in/a/walk.npz.svg", "in/a/b/walk.glb.svg"})
    CHECK_MESSAGE(ml::read_file(w / strip).starts_with("<svg"), strip);
  const auto set = w.run({"convert", "in", "set", "--features", "guoh3d"});
  CHECK_MESSAGE(contains(set.text, "set: 4 of 4 files converted"), set.text);
  CHECK(ml::read_ids(w / "set/all.txt").size() == 4);
  CHECK(w.run({"convert", "in", "kit", "--features", "kit"}).code == 0);
  CHECK(ml::HumanMl3dFolder(w / "kit", ml::kit_ml_form).features("walk").size() % 251 == 0);

  std::filesystem::create_symlink(w / "in/walk.bvh", w / "in/a/linked.bvh");  // stays in its place
  CHECK(w.run({"convert", "in/", "npz", "--as", ".npz"}).code == 0);
  CHECK(std::filesystem::exists(w / "npz/a/linked.npz"));

  const auto no_kind = w.run({"convert", "in", "out"}),
             no_folder = w.run({"convert", "in/walk.bvh", "x.bvh", "--as", ".bvh"});
  CHECK(no_kind.code == 2);
  CHECK_MESSAGE(contains(no_kind.text, "in is a folder"), no_kind.text);
  CHECK(no_folder.code == 2);
  for (const char* itself : {"in", "in/a/..", "./in/../in"}) {
    const auto refused = w.run({"convert", "in", itself, "--as", ".bvh"});
    CHECK(refused.code == 2);
    CHECK_MESSAGE(contains(refused.text, "[motionlang.config.102]"), refused.text);
  }
  CHECK(w.run({"convert", "in", "in2", "--as", ".bvh"}).code == 0);
}

TEST_CASE("convert makes loops in place") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const auto out = w.run({"convert", "walk.bvh", "loop.bvh", "--in-place", "--loop", "0.3", "--smooth"});
  REQUIRE_MESSAGE(out.code == 0, out.text);
  const auto walk = ml::read_bvh_motion(w / "walk.bvh"), loop = ml::read_bvh_motion(w / "loop.bvh");
  CHECK(loop.frames() == 34);
  const auto expected = ml::make_loop(ml::in_place(ml::smooth_motion(walk)), 6).motion;
  CHECK(synthetic::largest_distance(loop, expected) < 1e-3);
}

TEST_CASE("convert filters jitter by the 1 euro filter, with the defaults or other numbers") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const auto walk = ml::read_bvh_motion(w / "walk.bvh");
  const auto filtered = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"convert", "walk.bvh", "calm.bvh"});
    const auto out = w.run(more);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return ml::read_bvh_motion(w / "calm.bvh");
  };
  CHECK(synthetic::largest_distance(filtered({"--one-euro"}), ml::one_euro_filter(walk)) < 1e-3);
  const auto other = filtered({"--one-euro", "--one-euro-cutoff", "5", "--one-euro-beta", "0"});
  CHECK(synthetic::largest_distance(other, ml::one_euro_filter(walk, {.min_cutoff = 5, .beta = 0})) < 1e-3);
  CHECK(synthetic::largest_distance(other, ml::one_euro_filter(walk)) > 1e-2);
  CHECK(w.run({"convert", "walk.bvh", "calm.bvh", "--one-euro-beta", "1"}).code == 2);  // without the filter
}

TEST_CASE("convert: from one format to the others and back, cut, resampled, mirrored; strip and view") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const auto walk = ml::read_bvh_motion(w / "walk.bvh");  // joints depth first, as in the file
  for (const std::string there : {"walk.glb", "walk.npz"}) {
    const auto first = w.run({"convert", "walk.bvh", there, "--fps", "20"});
    REQUIRE_MESSAGE(first.code == 0, first.text);
    const auto second = w.run({"convert", there, "back.bvh", "--fps", "20"});
    REQUIRE_MESSAGE(second.code == 0, second.text);
    CHECK(synthetic::largest_distance(ml::read_bvh_motion(w / "back.bvh"), walk) < 1e-3);
  }
  const auto part =
      w.run({"convert", "walk.bvh", "part.bvh", "--from", "0.5", "--to", "1.5", "--fps", "40", "--mirror"});
  CHECK_MESSAGE(contains(part.text, "part.bvh: 39 frames at 40 per second, 0.97 s, 24 joints"), part.text);
  const auto expected = ml::mirror(ml::resample(ml::crop(walk, 10, 30), 40));
  CHECK(synthetic::largest_distance(ml::read_bvh_motion(w / "part.bvh"), expected) < 1e-3);

  CHECK(w.run({"strip", "walk.bvh"}).code == 0);
  CHECK(w.run({"view", "walk.bvh", "page.html"}).code == 0);
  CHECK(ml::read_file(w / "walk.bvh.svg").starts_with("<svg"));
  CHECK(w.run({"strip", "walk.bvh", "-o", "walk.PNG"}).code == 0);
  CHECK(ml::read_file(w / "walk.PNG").starts_with("\x89PNG"));
  ml::write_npz(w / "body.npz", octahedra::arrays());
  for (const char* out : {"body.glb", "body.html", "body.obj"}) {
    const auto made = w.run({"convert", "walk.bvh", out, "--body", "body.npz", "--betas", "1"});
    CHECK_MESSAGE(made.code == 0, made.text);
    CHECK_MESSAGE(contains(made.text, "1 motion on SMPL of 144 vertices"), made.text);
  }
  CHECK(ml::read_file(w / "body_0001.obj").starts_with("v "));
  const auto free = w.run({"convert", "walk.bvh", "free.obj", "--body", "free"});
  CHECK_MESSAGE(contains(free.text, "free.obj in 40 files, one for each frame: 1 motion on the free body of"),
                free.text);
  CHECK(ml::read_file(w / "free_0001.obj").starts_with("v "));
  CHECK(contains(ml::read_file(w / "body.html"), "\"triangles\""));
  CHECK(w.run({"view", "walk.bvh", "page.html", "--body", "body.npz"}).code == 0);
  CHECK(contains(w.run({"convert", "walk.bvh", "x.bvh", "--body", "body.npz"}).text,
                 "on a body are written to .glb and .html"));
  for (const char* features :
       {"guoh3d", "kit", "rifke", "rifke64", "smplvelp", "smplvelp-published", "smplrifke", "actor"}) {
    CAPTURE(features);
    CHECK(w.run({"convert", "walk.bvh", "rows.npy", "--features", features}).code == 0);
    CHECK(w.run({"convert", "rows.npy", "again.bvh"}).code == 0);  // back to another format
    CHECK(ml::read_bvh_motion(w / "again.bvh").frames() > 3);
  }
  CHECK(contains(w.run({"convert", "walk.bvh", "rows.npy", "--features", "smplvelp"}).text,
                 "rows.npy: 25 rows of 135 numbers at 12.5 per second, 2.00 s"));
  CHECK(contains(w.run({"convert", "walk.bvh", "rows.npy", "--features", "smplvelp", "--fps", "30"}).text,
                 "rows.npy: 59 rows of 135 numbers at 30 per second, 1.97 s"));
  CHECK(ml::read_npy(w / "rows.npy").shape == std::vector<ml::Index>{59, 135});
  const auto unknown_features = w.run({"convert", "walk.bvh", "rows.npy", "--features", "poses"});
  CHECK_MESSAGE(contains(unknown_features.text, "--features: poses not in {guoh3d,"), unknown_features.text);
  CHECK(contains(ml::read_file(w / "page.html"), "<html"));
  for (const char* file : {"walk.npz", "walk.bvh"})
    CHECK_MESSAGE(contains(w.run({"info", file}).text, "sliding at"), file);
  const auto page = w.run({"info", "page.html"});
  CHECK(page.code == 1);
  CHECK_MESSAGE(contains(page.text, "page.html: info shows weights, motions, timelines and captions, not '.html'"),
                page.text);

  const auto unknown = w.run({"convert", "walk.bvh", "walk.fbx"});
  CHECK(unknown.code == 2);
  CHECK_MESSAGE(contains(unknown.text,
                         "written to .bvh, .glb, .vrma, .npz, .npy, .html, .svg and .png, not '.fbx': Blender makes"),
                unknown.text);
  const auto empty = w.run({"convert", "walk.bvh", "none.bvh", "--from", "5"});
  CHECK(empty.code == 2);
  CHECK_MESSAGE(contains(empty.text, "nothing of its 2 s is between 5 and"), empty.text);
  CHECK(!std::filesystem::exists(w / "none.bvh"));
}

TEST_CASE("convert: feet that are fixed stand on the floor, whatever height the file gives its root at rest") {
  const Workplace w;
  auto sunk = synthetic::walk({.frames = 40});
  for (auto& r : sunk.root) r.y -= 0.3;
  ml::write_bvh(w / "sunk.bvh", sunk);
  REQUIRE(ml::read_bvh_motion(w / "sunk.bvh").skeleton.offset(0) == ml::Vec3<double>{});
  const auto out = w.run({"convert", "sunk.bvh", "fixed.npz", "--fix-feet"});
  REQUIRE_MESSAGE(out.code == 0, out.text);
  double lowest = 9;
  for (const auto& p : ml::read_amass(w / "fixed.npz").motion.positions()) lowest = std::min(lowest, p.y);
  CHECK(std::abs(lowest) < 0.02);
}

TEST_CASE("convert: several motions of a file, of which one that fails stops no other") {
  const Workplace w;
  std::vector<ml::Motion> several{synthetic::walk({.frames = 40, .fps = 30}), synthetic::walk({.frames = 1, .fps = 30}),
                                  synthetic::walk({.frames = 20, .fps = 30})};
  several[1].name = "pose", several[2].name = "short walk";
  ml::write_glb(w / "three.glb", several);
  const auto looped = w.run({"convert", "three.glb", "loop.bvh", "--loop", "0.2"});
  CHECK(looped.code == 1);
  CHECK_MESSAGE(contains(looped.text, "pose: [motionlang.config.101] make_loop: 6 frames to blend in a clip of 1"),
                looped.text);
  CHECK_MESSAGE(contains(looped.text, "1 of the 3 motions of three.glb could not be made"), looped.text);
  CHECK(std::filesystem::exists(w / "loop_short walk.bvh"));
  CHECK(!std::filesystem::exists(w / "loop_pose.bvh"));

  const auto mirrored = w.run({"convert", "three.glb", "again.glb", "--mirror"});  // all go to one file
  CHECK_MESSAGE(contains(mirrored.text, "again.glb: 3 motions, 24 joints"), mirrored.text);
  CHECK(ml::GlbFile::open(w / "again.glb").animation_names() == std::vector<std::string>{"walk", "pose", "short walk"});
  CHECK(w.run({"view", "three.glb"}).code == 0);
  const auto page = ml::read_file(w / "three.glb.html");
  for (const char* name : {"\"walk\"", "\"pose\"", "\"short walk\""}) CHECK(contains(page, name));
}

TEST_CASE("convert --skeleton: the result is on the joints of another motion, of its units") {
  const Workplace w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 20}));
  ml::Motion hero{rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:"), 30, {}, {}, "hero"};
  hero.root.assign(2, {0, 1, 0});
  hero.local.assign(2 * hero.skeleton.names.size(), ml::Quaternion<double>::identity());
  ml::write_bvh(w / "hero.bvh", hero, {.scale = 10});
  const Outcome made = w.run({"convert", "walk.bvh", "out.bvh", "--skeleton", "hero.bvh", "--units", "10"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  const ml::Motion out = ml::read_bvh_motion(w / "out.bvh", {.scale = 0.1}),
                   like = ml::read_bvh_motion(w / "hero.bvh", {.scale = 0.1});
  CHECK(out.frames() == 20);
  REQUIRE(out.skeleton.names == like.skeleton.names);
  for (int j = 1; j < out.skeleton.size(); ++j)
    CHECK(ml::norm(out.skeleton.offset(j) - like.skeleton.offset(j)) < 1e-4);
  const auto knee = static_cast<std::size_t>(ml::find_joint(out.skeleton, "LeftLeg"));
  CHECK(ml::distance(out.rotations(0)[knee], out.rotations(9)[knee]) > 0.05);
  CHECK_MESSAGE(contains(w.run({"convert", "walk.bvh", "out.npy", "--skeleton", "hero.bvh"}).text,
                         "--skeleton: is for results on any joints"),
                "npy");
}

TEST_CASE("convert: texts of BABEL become annotations, and these files of captions") {
  const Workplace w;
  ml::write_file(w / "babel.json", std::string_view(R"({
    "42": {"babel_sid": 42, "url": "", "feat_p": "X/X/s/f_poses.npz", "dur": 12.0,
      "seq_ann": {"labels": [{"raw_label": "walk", "proc_label": "walk and wave", "seg_id": "a", "act_cat": null}]},
      "frame_ann": {"labels": [{"proc_label": "sit down", "start_t": 7, "end_t": 9.5}]}},
    "43": {"babel_sid": 43, "url": "", "feat_p": "X/X/s/g_poses.npz", "dur": 1.5, "seq_ann": null}})"));
  const auto out = w.run({"convert", "babel.json", "annotations.json"});
  CHECK_MESSAGE(out.code == 0, out.text);
  CHECK_MESSAGE(contains(out.text, "annotations.json: 2 texts of 1 motion"), out.text);
  const auto made = ml::AnnotationFile::open(w / "annotations.json");
  CHECK(made.ids() == std::vector<std::string>{"00042"});
  CHECK(made.load("00042") ==
        ml::AnnotatedMotion{
            "00042", "X/s/f_poses", 12, {{"00042_0", "walk and wave", 0, 12, "a"}, {"00042_1", "sit down", 7, 9.5}}});
  REQUIRE(w.run({"convert", "annotations.json", "again.json"}).code == 0);
  CHECK(ml::read_file(w / "again.json") == ml::read_file(w / "annotations.json"));
  const auto texts = w.run({"convert", "annotations.json", "set"});
  CHECK_MESSAGE(contains(texts.text, "set/texts: 2 texts of 1 motion"), texts.text);
  CHECK(ml::read_file(w / "set/texts/00042.txt") == "walk and wave##0.0#0.0\nsit down##7.0#9.5\n");
  REQUIRE(w.run({"convert", "babel.json", "direct"}).code == 0);
  CHECK(w.files("direct/texts") == w.files("set/texts"));

  const auto other = w.run({"convert", "babel.json", "out.bvh"}),
             option = w.run({"convert", "babel.json", "out.json", "--mirror"});
  CHECK(other.code == 1);
  CHECK_MESSAGE(contains(other.text, "are written to .json, or into a folder as caption files, not '.bvh'"),
                other.text);
  CHECK(option.code == 2);
  CHECK_MESSAGE(contains(option.text, "--mirror: is not for texts of motions"), option.text);
  ml::write_file(w / "sharp.json", std::string_view(R"({"1": {"path": "p", "duration": 1, "annotations": [
    {"seg_id": "1_0", "text": "one", "start": 0, "end": 1},
    {"seg_id": "1_1", "text": "a # b", "start": 0, "end": 1}]}})"));
  const auto sharp = w.run({"convert", "sharp.json", "none"});
  CHECK_MESSAGE(contains(sharp.text, "[motionlang.timeline.510] 1.txt: 'a # b' is not allowed in a file of captions"),
                sharp.text);
  CHECK(!std::filesystem::exists(w / "none"));
}

TEST_CASE("convert: every ROOT of a BVH file is a motion; bones that stretch are reported") {
  const Workplace w;
  ml::write_file(w / "pair.bvh",
                 std::string_view(
                     "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 1 Xposition JOINT arm { OFFSET 0 100 0 CHANNELS 1 "
                     "Yposition } JOINT leg { OFFSET 0 -100 0 } } ROOT b { OFFSET 0 0 0 CHANNELS 1 Yposition JOINT c { "
                     "OFFSET 100 0 0 } } MOTION Frames: 2 Frame Time: 0.05\n0 100 5\n100 150 5\n"));
  const std::string told =
      "pair.bvh: left out: how 'arm' moves away from the joint before: bones keep their mean length";
  const auto out = w.run({"convert", "pair.bvh", "one.bvh"});
  REQUIRE_MESSAGE(out.code == 0, out.text);
  CHECK_MESSAGE(contains(out.text, told), out.text);
  CHECK(ml::read_bvh_motion(w / "one_a.bvh").root_at(1).x == doctest::Approx(1));
  const auto second = ml::read_bvh_motion(w / "one_b.bvh");
  CHECK(second.skeleton.names == std::vector<std::string>{"b", "c"});
  CHECK(second.root_at(1).y == doctest::Approx(0.05));
  CHECK(!contains(w.run({"convert", "one_a.bvh", "again.bvh"}).text, "left out"));
  CHECK(w.run({"convert", "pair.bvh", "figure.glb"}).code == 0);  // a GLB file has one skeleton
  CHECK(ml::GlbFile::open(w / "figure_b.glb").skeleton().names == second.skeleton.names);
  CHECK(w.run({"view", "pair.bvh"}).code == 0);
  const auto page = ml::read_file(w / "pair.bvh.html");
  for (const char* name : {"\"a\"", "\"b\""}) CHECK_MESSAGE(contains(page, name), name);
  const auto seen = w.run({"info", "pair.bvh"});
  CHECK_MESSAGE((contains(seen.text, told) && contains(seen.text, "2 roots\n  0 a, ")), seen.text);
  std::filesystem::create_directories(w / "data");
  std::filesystem::rename(w / "pair.bvh", w / "data/pair.bvh");
  const auto checked = w.run({"doctor", "data", "--all"});
  for (const char* name : {"pair.bvh a: ", "pair.bvh b: "}) CHECK_MESSAGE(contains(checked.text, name), checked.text);
}

TEST_CASE("convert: joints of a GLB file that move along their bones are reported, also on a character") {
  const Workplace w;
  ml::write_file(w / "rig.glb", rigs::glb_of(rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:")));
  ml::write_glb(w / "walk.glb", synthetic::walk({.frames = 40}));
  CHECK(!contains(w.run({"convert", "walk.glb", "walk.bvh"}).text, "left out"));
  std::string bytes = ml::read_file(w / "walk.glb");
  const std::string_view root = R"("target":{"node":0,"path":"translation"})",
                         spine = R"("target":{"node":3,"path":"translation"})";
  REQUIRE(contains(bytes, std::string(root)));
  ml::write_file(w / "stretched.glb", bytes.replace(bytes.find(root), root.size(), spine));
  const std::string told =
      "stretched.glb: left out: how 'spine1' moves away from the joint before: bones keep their length at rest\n";
  for (const auto& command : {std::vector<std::string>{"convert", "stretched.glb", "out.bvh"},
                              {"convert", "stretched.glb", "out.glb", "--rig", "rig.glb"},
                              {"info", "stretched.glb"}}) {
    const auto out = w.run(command);
    CHECK(out.code == 0);
    CHECK_MESSAGE(contains(out.text, told), out.text);
  }
}

TEST_CASE("--joints says which joint is which, of motions and of the character") {
  const Workplace w;
  auto walk = synthetic::walk({.frames = 20});
  std::string lines;
  for (std::string& name : walk.skeleton.names) {
    const std::string own = name == "pelvis" ? "hub" : name;  // the rest is known, but a body begins at its pelvis
    lines += name + "\t" + own + "\n";
    name = own;
  }
  ml::write_bvh(w / "bip.bvh", walk);
  ml::write_file(w / "bip.tsv", lines);
  ml::write_file(w / "short.tsv", "pelvis\thub\n\nleft_hip\thip.L\n");
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 20}));
  const auto refused = w.run({"convert", "bip.bvh", "out.bvh", "--smpl"});
  CHECK(refused.code != 0);
  CHECK_MESSAGE(contains(refused.text, "'hub'); the closest, SMPL, needs a joint 'pelvis'"), refused.text);
  CHECK_MESSAGE(contains(refused.text, "option --joints"), refused.text);
  const auto wrong = w.run({"convert", "bip.bvh", "out.bvh", "--joints", "short.tsv"});
  CHECK(wrong.code != 0);
  CHECK_MESSAGE(contains(wrong.text, "short.tsv:3: the skeleton has no joint 'hip.L'"), wrong.text);
  const auto made = w.run({"convert", "bip.bvh", "out.bvh", "--joints", "bip.tsv"});
  CHECK_MESSAGE(made.code == 0, made.text);
  ml::Motion out = ml::read_bvh_motion(w / "out.bvh"), wanted = ml::read_bvh_motion(w / "walk.bvh");
  ml::place_on_floor(out), ml::place_on_floor(wanted);
  CHECK(synthetic::largest_distance(out, wanted) < 1e-4);

  ml::write_file(w / "bip.glb", rigs::glb_of(walk.skeleton));
  CHECK(contains(w.run({"convert", "walk.bvh", "on_bip.glb", "--rig", "bip.glb"}).text, "option --joints"));
  const auto on_rig = w.run({"convert", "walk.bvh", "on_bip.glb", "--rig", "bip.glb", "--joints", "bip.tsv"});
  CHECK_MESSAGE(on_rig.code == 0, on_rig.text);
  CHECK_MESSAGE(contains(on_rig.text, "SMPL -> bip.tsv: 24 of 24 joints follow"), on_rig.text);
  CHECK(
      contains(w.run({"generate", "--text", "a person walks", "--joints", "bip.tsv"}).text, "--joints requires --rig"));
}

TEST_CASE("convert: options that would be left out are refused; the message says how joints follow") {
  const Workplace w;
  ml::write_file(w / "rig.glb", rigs::glb_of(rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:")));
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 40}));
  const std::vector<std::pair<std::vector<std::string>, std::string>> refused{
      {{"--rig", "rig.glb", "--features", "guoh3d"}, "--rig excludes --features"},
      {{"--rig", "rig.glb", "--body", "free"}, "--rig excludes --body"},
      {{"--body", "free", "--features", "guoh3d"}, "--body excludes --features"},
      {{"--betas", "1"}, "--betas requires --body"},
      {{"--drop-animations"}, "--drop-animations requires --rig"},
      {{"--action", "walk"}, "--action requires --denoise"},
      {{"--statistics", "."}, "--statistics requires --denoise"}};
  for (auto [options, message] : refused) {
    options.insert(options.begin(), {"convert", "walk.bvh", "out.glb"});
    const auto out = w.run(options);
    CHECK(out.code == 2);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  }
  const auto endless = w.run({"convert", "walk.bvh", "out.bvh", "--fps", "1e300"});
  CHECK(endless.code == 1);
  CHECK_MESSAGE(contains(endless.text, "[motionlang.config.101] resample: 'walk' of 2 s at 1e+300"), endless.text);

  REQUIRE(w.run({"convert", "walk.bvh", "mixamo.glb", "--rig", "rig.glb", "--drop-animations"}).code == 0);
  CHECK(contains(w.run({"convert", "mixamo.glb", "smpl.bvh", "--smpl"}).text, "Mixamo -> SMPL: "));
  CHECK(contains(w.run({"convert", "mixamo.glb", "smpl.npz"}).text, "Mixamo -> SMPL: "));
  CHECK(contains(w.run({"convert", "mixamo.glb", "rows.npy", "--features", "rifke"}).text, "Mixamo -> SMPL: "));
  CHECK(!contains(w.run({"convert", "walk.bvh", "smpl.npz"}).text, "SMPL -> SMPL"));
}

TEST_CASE("convert: clips are added to a data set in HumanML3D's or KIT-ML's form, captions that are there are kept") {
  const Workplace w;
  std::vector<ml::Motion> two(2, synthetic::walk({.frames = 40, .fps = 30}));
  ml::write_glb(w / "walk.glb", two);
  const auto out = w.run({"convert", "walk.glb", "set", "--features", "guoh3d"});
  REQUIRE_MESSAGE(out.code == 0, out.text);
  CHECK_MESSAGE(contains(out.text, "set: clip walk_2, 26 frames at 20 per second, 0 captions"), out.text);
  ml::write_file(w / "set/texts/walk.txt", "a person walks.#a/DET person/NOUN walk/VERB#0.0#0.0\n");
  CHECK(contains(w.run({"convert", "walk.glb", "set", "--features", "guoh3d"}).text,
                 "set: clip walk, 26 frames at 20 per second, 1 caption"));
  const ml::HumanMl3dFolder set(w / "set");
  CHECK(set.ids() == std::vector<std::string>{"walk", "walk_2"});
  const auto clip = set.load("walk");
  CHECK(clip.frames == 26);
  CHECK(clip.is_finite());
  CHECK(clip.captions.at(0).text == "a person walks.");
  CHECK(w.run({"convert", "walk.glb", "set", "--features", "rifke"}).code == 1);

  const auto kit = w.run({"convert", "walk.glb", "kit", "--features", "kit"});
  REQUIRE_MESSAGE(kit.code == 0, kit.text);
  CHECK_MESSAGE(contains(kit.text, "kit: clip walk_2, 16 frames at 12.5 per second, 0 captions"), kit.text);
  const auto on_kit = ml::HumanMl3dFolder(w / "kit", ml::kit_ml_form).load("walk");
  CHECK(on_kit.frames == 16);
  CHECK(on_kit.joints[1] > 300);  // height of the root in KIT's units, 640 in a metre
  CHECK(synthetic::largest_distance(ml::read_motion_npy(w / "kit/new_joints/walk.npy"),
                                    ml::read_motion_npy(w / "kit/new_joint_vecs/walk.npy")) < 1e-3);
  const auto guoh3d_into_kit = w.run({"convert", "walk.glb", "kit", "--features", "guoh3d"});
  CHECK(guoh3d_into_kit.code == 1);
  CHECK_MESSAGE(contains(guoh3d_into_kit.text,
                         "kit/new_joint_vecs/walk.npy: rows of 251 numbers (kit), the new clip has "
                         "rows of 263 (guoh3d)"),
                guoh3d_into_kit.text);
  CHECK(ml::read_ids(w / "kit/all.txt").size() == 2);
  std::filesystem::remove(w / "kit/all.txt");  // the form is that of any clip
  CHECK(w.run({"convert", "walk.glb", "kit", "--features", "guoh3d"}).code == 1);

  // as motions the clips of a data set are read once: not its joints as well
  REQUIRE(w.run({"convert", "kit", "from_kit", "--as", ".bvh"}).code == 0);
  CHECK(std::filesystem::exists(w / "from_kit/new_joint_vecs/walk.bvh"));
  CHECK(!std::filesystem::exists(w / "from_kit/new_joints"));
}

TEST_CASE("an .npz file with the names of smplx and without a rate: --rate says it, but not another than the file's") {
  const Workplace w;
  const auto array = [](ml::Index columns) {
    const std::vector<double> values(static_cast<std::size_t>(4 * columns), 0.1);
    return ml::NpyArray::of(std::span<const double>(values), {4, columns});
  };
  std::vector<ml::NamedArray> arrays{{"global_orient", array(3)}, {"body_pose", array(69)}, {"transl", array(3)}};
  std::filesystem::create_directories(w / "data");
  ml::write_npz(w / "data/none.npz", arrays);
  arrays.push_back({"fps", ml::NpyArray::scalar(60.0)});
  ml::write_npz(w / "data/own.npz", arrays);
  const auto none = w.run({"convert", "data/none.npz", "a.bvh"});
  CHECK(none.code == 1);
  CHECK_MESSAGE(contains(none.text, "[motionlang.io.406] data/none.npz: no frame rate"), none.text);
  CHECK_MESSAGE(contains(none.text, "; set --rate"), none.text);
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--body", "free"}}) {
    std::vector<std::string> words{"convert", "data/none.npz", "a.glb", "--rate", "30"};
    words.insert(words.end(), more.begin(), more.end());
    const auto given = w.run(words);
    CHECK_MESSAGE(given.code == 0, given.text);
    CHECK(ml::GlbFile::open(w / "a.glb").motion(0).fps == doctest::Approx(30));
    words[1] = "data/own.npz";
    const auto both = w.run(words);
    CHECK(both.code != 0);
    CHECK_MESSAGE(contains(both.text, "[motionlang.config.102] data/own.npz: has 60 frames per second, --rate says 30"),
                  both.text);
  }
  CHECK(contains(w.run({"convert", "data/own.npz", "own.npz"}).text, "4 frames at 60 per second"));
  CHECK(contains(w.run({"info", "data/own.npz"}).text, "data/own.npz: 4 frames, 60 frames per second"));
  REQUIRE(w.run({"convert", "data", "out", "--as", ".npz", "--rate", "30"}).code == 0);  // a folder of both
  CHECK(ml::read_amass(w / "out/none.npz").motion.fps == 30);
  CHECK(ml::read_amass(w / "out/own.npz").motion.fps == 60);
}

TEST_CASE("results of MDM: every motion, named by its text") {
  const Workplace w;
  std::vector<float> values(2 * 22 * 3 * 10);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i / 10 % 66) / 66;  // stands
  const auto motion = ml::NpyArray::of(std::span<const float>(values), {2, 22, 3, 10});
  std::filesystem::create_directories(w / "mdm");
  ml::write_file(w / "mdm/results.npy",
                 mdm::results(motion, {"a person waves / sits", "a person waves / sits"}, {10, 6}));
  const auto seen = w.run({"info", "mdm/results.npy"});
  CHECK_MESSAGE(
      contains(seen.text, "2 motions\n  0 a person waves / sits, 0.50 s\n  1 a person waves / sits_2, 0.30 s\n"),
      seen.text);
  CHECK(contains(seen.text, "10 frames, 20 frames per second, 0.50 s, 24 joints"));
  const auto made = w.run({"convert", "mdm/results.npy", "x.bvh", "--rate", "30"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  CHECK(contains(made.text, "x_a person waves _ sits.bvh: 10 frames at 30 per second"));
  CHECK(ml::read_bvh_motion(w / "x_a person waves _ sits_2.bvh").frames() == 6);
  const auto page = w.run({"view", "mdm/results.npy"});
  CHECK_MESSAGE(contains(page.text, "mdm/results.npy.html: 2 motions, 24 joints"), page.text);
  const auto all = w.run({"convert", "mdm", "all", "--as", ".bvh"});
  CHECK_MESSAGE(contains(all.text, "all: 1 of 1 file converted"), all.text);
  ml::write_npy(w / "bare.npy", motion);
  CHECK(contains(w.run({"convert", "bare.npy", "bare.bvh"}).text, "bare_1.bvh: 10 frames at 20 per second"));
}

TEST_CASE("convert: what an AMASS file has besides the joints goes into another one, or is reported") {
  const Workplace w;
  std::vector<double> poses(2 * 156), trans(6), betas{1.5, -2};
  poses[100] = 0.5;
  const std::vector<ml::NamedArray> arrays{{"poses", ml::NpyArray::of(std::span<const double>(poses), {2, 156})},
                                           {"trans", ml::NpyArray::of(std::span<const double>(trans), {2, 3})},
                                           {"betas", ml::NpyArray::of(std::span<const double>(betas), {2})},
                                           {"gender", ml::NpyArray::text("female")},
                                           {"mocap_framerate", ml::NpyArray::scalar(60.0)}};
  ml::write_npz(w / "a.npz", arrays);
  const auto same = w.run({"convert", "a.npz", "b.npz"});
  CHECK_MESSAGE(contains(same.text, "a.npz: left out: hands and face; --body shows them"), same.text);
  const auto back = ml::read_amass(w / "b.npz");
  CHECK(back.body.gender == "female");
  CHECK(back.body.betas == betas);
  CHECK(contains(w.run({"convert", "a.npz", "b.bvh"}).text, "left out: hands, face and betas"));

  std::filesystem::create_directories(w / "data");
  ml::write_npz(w / "data/a.npz", arrays);
  ml::write_npz(w / "data/b.npz", arrays);
  ml::write_bvh(w / "data/c.bvh", synthetic::walk({.frames = 10, .fps = 30}));
  const auto folder = w.run({"convert", "data", "out", "--as", ".bvh"});
  CHECK_MESSAGE(
      contains(folder.text,
               "data/a.npz: left out: hands, face and betas; --body shows them (and of 1 more)\nout: 3 of 3 files"),
      folder.text);
}
