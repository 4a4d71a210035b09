// GLB files as other programs write them: small files that once were read wrongly or refused, with the right values.
// Random documents, whose joints are compared with an independent calculation.
#include <doctest/doctest.h>

#include <motionlang/core/rng.hpp>
#include <motionlang/formats/glb_rig.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/kinematics/on_smpl.hpp>
#include <motionlang/kinematics/retarget.hpp>

#include "../../support/check_error.hpp"
#include "../../support/gltf_builder.hpp"
#include "../../support/gltf_world.hpp"
#include "../../support/rigs.hpp"
#include "../../support/tests_folder.hpp"

namespace ml = motionlang;
using gltf::Builder;
using nlohmann::json;

namespace {

std::filesystem::path data(const char* name) {
  return std::filesystem::path(tests_folder()) / "unit/formats/data" / name;
}
/// The only motion of a file of the tests, and the lines about it.
struct Read {
  std::string notes{};
  ml::Motion motion;

  explicit Read(const char* name) : motion(ml::read_motion(data(name), {}, &notes)) {}
  bool notes_that(const std::string& text) const { return notes.find(text) != notes.npos; }
  ml::Vec3<double> path() const { return motion.root.back() - motion.root.front(); }
  ml::Vec3<double> at(const char* joint, ml::Index frame) const {
    ml::JointTransforms<double> world;
    motion.world(frame, world);
    return world.position[static_cast<std::size_t>(motion.skeleton[joint])];
  }
};
gltf::World world_of(const char* name) { return gltf::World(ml::MappedFile::open(data(name))->bytes()); }

void check_walk(const Read& r, int joints, const char* root) {
  CHECK(r.motion.skeleton.size() == joints);
  CHECK(r.motion.skeleton.names.front() == root);
  CHECK(r.motion.frames() == 31);
  CHECK(r.motion.fps == 30);
  CHECK(norm(r.path() - ml::Vec3{0.2, 0.0, 1.2}) < 1e-6);
  const ml::Motion smpl = ml::on_smpl(r.motion);
  const auto path = smpl.root.back() - smpl.root.front();
  CHECK(norm(path - ml::Vec3{0.195, 0.0, 1.171}) < 1e-3);
  CHECK(!r.notes_that("walk is lost"));
}

}  // namespace

TEST_CASE("the path is that of the hips, whatever moves beside them") {
  const Read vrma("expression_lookat.vrma");
  check_walk(vrma, 22, "hips");
  CHECK(vrma.notes == data("expression_lookat.vrma").string() +
                          ": left out: how 'happy' and 'lookAt' move: they are not joints of the body\n");
  const Read camera("noskin_animated_camera.glb");
  check_walk(camera, 22, "pelvis");
  CHECK(camera.notes_that("left out: how 'Camera' moves: it is not a joint of the body\n"));
}

TEST_CASE("the body is read, not the first skin; joints without keys belong to it; packed meshes do not matter") {
  check_walk(Read("small_skin_first.glb"), 24, "mixamorig:Hips");
  check_walk(Read("noskin_resting_joints.glb"), 22, "mixamorig:Hips");
  for (const char* packed : {"draco_mesh_plain_animation.glb", "meshopt_mesh_plain_animation.glb"}) {
    CAPTURE(packed);
    const Read r(packed);
    check_walk(r, 22, "mixamorig:Hips");
    CHECK(r.notes.empty());
  }
}

TEST_CASE("times that glTF does not allow are read, and the notes say how") {
  const Read negative("negative_times.glb");
  check_walk(negative, 22, "mixamorig:Hips");
  CHECK(negative.notes_that("animation 'w' begins at -0.2 s: all its keys are moved so that it begins at 0 s\n"));
  const Read equal("equal_times.glb");
  CHECK(equal.notes_that("animation 'w' has several keys at one time: the last of them counts\n"));
  CHECK(equal.motion.fps == 30);
  CHECK(equal.motion.frames() == 31);
  const gltf::World world = world_of("equal_times.glb");
  CHECK(gltf::farthest(equal.motion, world) < 1e-5);
}

TEST_CASE("curves between keys are sampled as often as they bend") {
  const Read cubic("cubic_keys_10_per_second.glb");
  CHECK(cubic.motion.fps == 30);
  CHECK(cubic.motion.frames() == 31);
  CHECK(gltf::farthest(cubic.motion, world_of("cubic_keys_10_per_second.glb")) < 1e-5);
}

TEST_CASE("scales: places in the world, or a note of how far they are off") {
  const Read mirrored("scale_mirrorarm.glb");
  CHECK(norm(mirrored.at("mixamorig:LeftHand", 15) - ml::Vec3{-0.5223, 1.8896, 0.4723}) < 1e-4);
  CHECK(norm(mirrored.at("mixamorig:RightHand", 15) - ml::Vec3{0.57, 1.44, 0.8027}) < 1e-4);
  CHECK(norm(mirrored.at("mixamorig:LeftToeBase", 15) - ml::Vec3{-0.2462, 0.0428, 0.7726}) < 1e-4);
  CHECK(mirrored.notes.empty());
  CHECK(gltf::farthest(mirrored.motion, world_of("scale_mirrorarm.glb")) < 1e-5);

  const Read animated("armature_scale_animated.glb");
  CHECK(norm(animated.at("mixamorig:LeftHand", 15) - ml::Vec3{0.5223, 1.8896, 0.4723}) < 1e-4);
  CHECK(gltf::farthest(animated.motion, world_of("armature_scale_animated.glb")) < 1e-5);
  CHECK(animated.notes.empty());

  const Read uneven("scale_nonuni_arm.glb");
  const double off = gltf::farthest(uneven.motion, world_of("scale_nonuni_arm.glb"));
  CHECK(off > 0.01);
  CHECK(uneven.notes_that("joints are up to " + ml::concat_text(std::round(off * 1000) / 1000) +
                          " m from where the file has them: "));
}

TEST_CASE("an animation that moves no joint has a note") {
  const Read smile("animation_of_no_joint.glb");
  CHECK(smile.notes_that("animation 'smile' moves no joint: the motion is the rest pose\n"));
  CHECK(smile.motion.frames() == 1);
}

namespace {

float number(ml::Philox& random, double low, double high) {
  return static_cast<float>(low + (high - low) * random.uniform());
}
std::vector<float> turn(ml::Philox& random, double most = 3) {
  const ml::Vec3<double> axis{random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5};
  const auto q = ml::from_axis_angle(ml::normalized(axis + ml::Vec3{0.01, 0.0, 0.0}), most * (random.uniform() - 0.5));
  return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)};
}
std::vector<float> vector(ml::Philox& random, double most) {
  return {number(random, -most, most), number(random, -most, most), number(random, -most, most)};
}
template <class F>
std::vector<float> keys(std::size_t count, F value) {
  std::vector<float> out;
  for (std::size_t k = 0; k < count; ++k) {
    const auto v = value();
    out.insert(out.end(), v.begin(), v.end());
  }
  return out;
}

/// A figure of a table below a random armature, with random things beside its hips, under random rest rotations.
struct Figure {
  Builder b;
  std::vector<int> above{}, beside{}, joints{};
  ml::Skeleton skeleton;

  /// turned   whether the rotations of nodes at rest are random
  Figure(ml::Philox& random, const char* table, double turned, const std::string& prefix = {})
      : skeleton(rigs::skeleton_of(ml::skeleton_table(table), 0, 1, {}, prefix)) {
    add(random, turned);
  }
  void add(ml::Philox& random, double turned) {
    const int armatures = 1 + static_cast<int>(random.below(3));
    above.clear(), beside.clear(), joints.clear();
    for (int i = 0; i < armatures; ++i) {
      above.push_back(b.node({{"name", "armature" + std::to_string(i)},
                              {"translation", vector(random, 0.5)},
                              {"rotation", turn(random, turned)}}));
      if (i > 0) b.child(above[above.size() - 2], above.back());
    }
    for (int i = 0; i < 4; ++i) {
      beside.push_back(b.node({{"name", "beside" + std::to_string(i)}, {"translation", vector(random, 2)}}));
      if (random.below(2) == 0) b.child(above[random.below(static_cast<std::uint32_t>(armatures))], beside.back());
    }
    for (int j = 0; j < skeleton.size(); ++j) {
      const auto& o = skeleton.offset(j);
      joints.push_back(b.node({{"name", skeleton.name(j)}, {"translation", {o.x, o.y, o.z}}}));
      b.child(j == 0 ? above.back() : joints[static_cast<std::size_t>(skeleton.parent(j))], joints.back());
      if (turned > 0) b.document["nodes"].back()["rotation"] = turn(random, 0.3 * turned);
    }
  }
  json& node(int n) { return b.document["nodes"][static_cast<std::size_t>(n)]; }
  /// Random keys of everything: places of the hips and of what is above and beside them, turns of all.
  void animate(ml::Philox& random, const std::vector<float>& times, const char* mode = "LINEAR") {
    const std::size_t count = times.size() * (std::string_view(mode) == "CUBICSPLINE" ? 3 : 1);
    const int input = b.floats(times, "SCALAR");
    const auto move = [&](int n, double most) {
      b.animate(n, "translation", input, b.floats(keys(count, [&] { return vector(random, most); }), "VEC3"), mode);
    };
    const auto rotate = [&](int n) {
      b.animate(n, "rotation", input, b.floats(keys(count, [&] { return turn(random); }), "VEC4"), mode);
    };
    for (const int n : above) move(n, 1), rotate(n);
    for (const int n : beside) move(n, 3);
    move(joints[1], 2);  // the hips, on a joint at the floor
    for (const int n : joints) rotate(n);
  }
  std::string hips() const { return skeleton.names[1]; }
};

}  // namespace

TEST_CASE("random trees: the hips are the root, what is beside them is left out, and joints are where they should be") {
  ml::Philox random{.seed = 1};
  for (const char* table : {"Mixamo", "Unreal 5", "VRM", "SMPL", "KayKit", "Quaternius"}) {
    for (int round = 0; round < 4; ++round) {
      CAPTURE(table);
      CAPTURE(round);
      Figure f(random, table, 1);
      f.animate(random, {0, 0.5f, 1});
      if (round % 2 == 1) {  // with a skin over everything
        json all = f.above;
        for (const auto* more : {&f.beside, &f.joints}) {
          for (const int n : *more) all.push_back(n);
        }
        f.b.skin(all);
      }
      const auto bytes = f.b.bytes();
      const ml::GlbFile file(bytes, "random.glb");
      REQUIRE(file.figures() == 1);
      CHECK(file.skeleton().names.front() == f.hips());
      CHECK(file.skeleton().size() == f.skeleton.size() - 1);
      CHECK(file.moving_others().size() == 4);
      ml::GlbLoss loss;
      const ml::Motion motion = file.motion(0, 20, 0, &loss);
      CHECK(gltf::farthest(motion, gltf::World(bytes)) < 1e-5);
      CHECK(loss.distance < 1e-5);
      CHECK(!loss.walk_lost);
      CHECK(ml::GlbRig(bytes, "rig").skeleton() == file.skeleton());
    }
  }
}

TEST_CASE("a body that joints beside the root carry away: the walk is lost, which is measured") {
  Builder b;  // no table knows it, and both halves have joints that move vertices
  const int root = b.node({{"name", "root"}}), tail = b.node({{"name", "tail"}, {"translation", {0, 0, -1}}});
  std::vector<int> body{b.node({{"name", "body"}, {"translation", {0, 1, 0}}})};
  b.child(root, tail), b.child(root, body[0]);
  for (int i = 0; i < 6; ++i) {
    body.push_back(b.node({{"translation", {0, 0.2, 0}}}));
    b.child(body[static_cast<std::size_t>(i)], body.back());
  }
  json all = body;
  all.push_back(root), all.push_back(tail);
  b.skin(all);
  const int times = b.floats({0, 1}, "SCALAR");
  b.animate(body[0], "translation", times, b.floats({0, 1, 0, 0, 1, 4}, "VEC3"));
  b.animate(tail, "translation", times, b.floats({0, 0, -1, 0, 0, -1}, "VEC3"));
  const auto weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0}, "VEC4"), joints = b.floats({0, 0, 0, 0, 8, 0, 0, 0}, "VEC4");
  b.document["meshes"] =
      json::array({{{"primitives", json::array({{{"attributes", {{"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}}})}}});
  b.node({{"mesh", 0}, {"skin", 0}});
  std::string notes;
  const auto motions = ml::parse_motions(b.bytes(), "lost.glb", {}, &notes);
  CHECK(motions.front().skeleton.names.front() == "root");
  CHECK(notes.find("lost.glb: left out: how 'body' moves away from the joint before: bones keep their length at "
                   "rest\n") != notes.npos);
  CHECK(notes.find("lost.glb: joints are up to 4 m from where the file has them: 'body' at 1 s\n") != notes.npos);
  CHECK(notes.find("lost.glb: the walk is lost: joints that are left out carry the body\n") != notes.npos);
}

TEST_CASE("several figures are several motions, each of what moves it") {
  ml::Philox random{.seed = 2};
  Figure f(random, "Mixamo", 1, "mixamorig:");
  const auto first = f.joints;
  f.node(f.above.front())["name"] = "Anna";
  f.animate(random, {0, 1});
  f.skeleton = rigs::skeleton_of(ml::skeleton_table("Unreal 4"));
  f.skeleton.names.back() = "thumb_l";
  f.add(random, 1);
  f.node(f.above.front())["name"] = "Bert";
  f.animate(random, {0, 1});
  for (const bool skins : {false, true}) {
    if (skins) f.b.skin(f.joints), f.b.skin(first);
    const auto bytes = f.b.bytes();
    std::string notes;
    const auto motions = ml::parse_motions(bytes, "two.glb", {}, &notes);
    REQUIRE(motions.size() == 2);
    const std::size_t anna = skins ? 1 : 0;  // in the order of the skins
    CHECK(motions[anna].name == "clip Anna");
    CHECK(motions[1 - anna].name == "clip Bert");
    CHECK(motions[anna].skeleton.names.front() == "mixamorig:Hips");
    CHECK(motions[1 - anna].skeleton.names.front() == "pelvis");
    for (const ml::Motion& m : motions) CHECK(gltf::farthest(m, gltf::World(bytes)) < 1e-5);
  }
  f.b.document["animations"][0]["name"] = "both";
  const auto channels = f.b.document["animations"][0]["channels"];
  json only = json::array();
  for (const auto& c : channels) {
    if (c["target"]["node"].get<int>() > first.back()) only.push_back(c);
  }
  f.b.document["animations"].push_back(f.b.document["animations"][0]);
  f.b.document["animations"][1]["channels"] = only;
  f.b.document["animations"][1]["name"] = "solo";
  std::vector<std::string> names;
  for (const auto& m : f.b.file().motions()) names.push_back(m.name);
  CHECK(names == std::vector<std::string>{"both Bert", "both Anna", "solo"});
}

TEST_CASE("the rest pose is the T-pose, whether nodes or inverse bind matrices have it") {
  ml::Philox random{.seed = 3};
  for (int round = 0; round < 12; ++round) {
    CAPTURE(round);
    Figure f(random, "Mixamo", 0);
    for (const int n : f.above) f.node(n)["rotation"] = {0, 0, 0, 1};
    const bool nodes_bent = round % 2 == 0;
    const auto bend = [&] {  // legs and arms as somebody sits, and the trunk leans
      for (const int n : f.joints) {
        const std::string name = f.node(n)["name"];
        const bool limb = name.ends_with("UpLeg") || name.ends_with("Arm") || name.ends_with("Spine");
        if (limb) f.node(n)["rotation"] = turn(random, 2);
      }
    };
    if (!nodes_bent) bend();
    // inverse bind matrices of what the nodes are now, in the space of the armature
    std::vector<float> inverse_bind;
    const gltf::World bound(f.b.bytes());
    const int armature = f.above.back();
    for (const int n : f.joints) {
      const auto a = bound.matrix(armature, -1), m = bound.matrix(n, -1);
      for (std::size_t column = 0; column < 4; ++column) {  // the inverse of a rotation and a translation from there
        for (std::size_t row = 0; row < 4; ++row) {
          double x = row == column ? 1 : 0;
          if (row < 3 && column < 3) x = m[4 * column + row];
          if (row < 3 && column == 3) {
            x = 0;
            for (std::size_t k = 0; k < 3; ++k) x -= m[4 * k + row] * (m[4 * k + 3] - a[4 * k + 3]);
          }
          inverse_bind.push_back(static_cast<float>(x));
        }
      }
    }
    for (const int n : f.joints) f.node(n).erase("rotation");
    if (nodes_bent) bend();
    f.b.skin(f.joints);
    f.b.document["skins"][0]["inverseBindMatrices"] = f.b.floats(inverse_bind, "MAT4");
    f.animate(random, {0, 0.5f, 1});
    const auto bytes = f.b.bytes();
    const ml::GlbFile file(bytes, "bent.glb");
    const ml::Motion motion = file.motion(0, 30);
    CHECK(gltf::farthest(motion, gltf::World(bytes)) < 1e-5);
    for (int j = 1; j < file.skeleton().size(); ++j) {
      const int same = f.skeleton[file.skeleton().name(j)];
      CHECK(norm(file.skeleton().offset(j) - f.skeleton.offset(same)) < 1e-5);
    }
    // a character with that rest pose moves as it should
    const auto walk = synthetic::walk({.frames = 5});
    Builder damaged = f.b;  // matrices that are not in the file: the nodes are at rest
    const auto matrices = damaged.document["skins"][0]["inverseBindMatrices"].get<std::size_t>();
    damaged.document["accessors"][matrices]["count"] = 1'000'000'000;
    CHECK(gltf::farthest(damaged.file().motion(0, 30), gltf::World(bytes)) < 1e-5);
    const ml::GlbRig rig(bytes, "bent.glb");
    const auto want = ml::retarget(walk, rig.skeleton());
    const auto made = rig.with(std::span(&want, 1), {.keep_animations = false});
    CHECK(gltf::farthest(want, gltf::World(made)) < 1e-5);
  }
}

TEST_CASE("random first keys and rates: frames are at the keys") {
  ml::Philox random{.seed = 4};
  for (const double rate : {12.0, 24.0, 25.0, 29.97, 30.0, 60.0, 120.0}) {
    for (int round = 0; round < 4; ++round) {
      CAPTURE(rate);
      CAPTURE(round);
      Figure f(random, "Mixamo", 1);
      const int first = static_cast<int>(random.below(40));
      const double shift = round < 2 ? 0 : random.uniform() / rate;  // part of a frame
      const bool sparse = round % 2 == 1;                            // keys that programs left out
      std::vector<float> times;
      for (int k = 0; k < 40; ++k) {
        if (!sparse || k < 2 || k == 39 || random.below(3) == 0)
          times.push_back(static_cast<float>((first + k) / rate + shift));
      }
      f.animate(random, times);
      const auto bytes = f.b.bytes();
      const ml::GlbFile file(bytes, "rate.glb");
      const ml::Motion motion = file.motion(0);
      const double want = sparse && rate < 20 ? 24 : rate;
      CHECK(motion.fps == doctest::Approx(want).epsilon(1e-5));
      const double begin = shift * rate < 0.01 || shift * rate > 0.99 ? 0 : shift;
      CHECK(motion.frames() == std::floor((times.back() - begin) * motion.fps + 0.01) + 1);
      const gltf::World world(bytes);
      CHECK(gltf::farthest(motion, world, begin) < 1e-3);  // times are floats, and so is begin
      for (const float t : times) {                        // every key is a frame
        const double frame = (t - begin) * motion.fps;
        CHECK(std::abs(frame - std::round(frame)) < 0.02);
      }
    }
  }
}

TEST_CASE("rates of curves, of slow keys, of keys at no rate and of held poses; rates that nobody means") {
  ml::Philox random{.seed = 5};
  const auto rate = [&](std::vector<float> times, const char* mode = "LINEAR") {
    Figure f(random, "Mixamo", 1);
    f.animate(random, times, mode);
    return f.b.file().rate(0);
  };
  const auto at = [](double fps) {
    std::vector<float> out;
    for (int k = 0; k < 20; ++k) out.push_back(static_cast<float>(k / fps));
    return out;
  };
  for (const auto& [keys, curve] :
       std::vector<std::pair<double, double>>{{10, 30}, {12, 36}, {24, 48}, {25, 50}, {60, 60}}) {
    CHECK(rate(at(keys), "CUBICSPLINE") == doctest::Approx(curve));
    CHECK(rate(at(keys)) == doctest::Approx(keys));
    CHECK(rate(at(keys), "STEP") == doctest::Approx(keys));
  }
  CHECK(rate(at(4)) == doctest::Approx(32));
  CHECK(rate({0, 2.3f}) == 30);
  CHECK(rate({0, 0.317f, 0.7711f, 0.9013f, 1.7177f, 2.0019f}) == 30);
  std::vector<float> camera{0};
  while (camera.size() < 200) camera.push_back(camera.back() + number(random, 0.012, 0.021));  // some 60 per second
  CHECK(rate(camera) > 50);
  CHECK(rate(camera) < 75);

  Figure held(random, "Mixamo", 1);  // a joint that is held, with two times of its own
  held.animate(random, at(24));
  held.b.document["animations"][0]["channels"].erase(held.b.document["animations"][0]["channels"].size() - 1);
  held.b.animate(held.joints.back(), "rotation", held.b.floats({0.0123f, 0.777f}, "SCALAR"),
                 held.b.floats({0, 0, 0, 1, 0, 0, 0, 1}, "VEC4"));
  CHECK(held.b.file().rate(0) == 24);
  CHECK_ERROR(held.b.file().motion(0, 9e5), "rotations (frames x joints), at most 10000000 of ");
  CHECK_ERROR(held.b.file().motion(0, 9e5), "[motionlang.io.405] test.glb: animation 'clip' of 0.79");
}

TEST_CASE(
    "even scales, mirror images and scales that are held: joints to 1e-5 m; uneven ones: as far off as the loss") {
  ml::Philox random{.seed = 6};
  for (int round = 0; round < 24; ++round) {
    CAPTURE(round);
    Figure f(random, "Mixamo", 1);
    const bool uneven = round % 4 == 3;
    for (const int n : f.above) {
      const float s = number(random, 0.5, 2);
      std::vector<float> scale{s, s, s};
      if (round % 2 == 1 && n == f.above.front()) scale[random.below(3)] *= -1;
      if (uneven) scale = {s, number(random, 0.5, 2), number(random, 0.5, 2)};
      f.node(n)["scale"] = scale;
    }
    for (const int n : f.joints) {
      const float s = number(random, 0.8, 1.25);
      if (random.below(3) == 0) f.node(n)["scale"] = {s, s, s};
    }
    f.animate(random, {0, 0.5f, 1});
    if (round % 4 == 2) {  // other sizes all the time, of an armature and of a bone
      const int input = f.b.floats({0, 1}, "SCALAR");
      const float s = number(random, 0.01, 0.1);
      f.b.animate(f.above.front(), "scale", input, f.b.floats({s, s, s, s, s, s}, "VEC3"));
      const auto t = vector(random, 0.5);
      f.b.animate(f.joints[4], "translation", input, f.b.floats({t[0], t[1], t[2], t[0], t[1], t[2]}, "VEC3"));
    }
    const auto bytes = f.b.bytes();
    const ml::GlbFile file(bytes, "scaled.glb");
    ml::GlbLoss loss;
    const ml::Motion motion = file.motion(0, 10, 0, &loss);
    motion.validate();
    const double off = gltf::farthest(motion, gltf::World(bytes));
    if (!uneven) CHECK(off < 1e-5);
    if (uneven) CHECK(off > 0.01);
    CHECK(std::abs(off - loss.distance) < 1e-5);
  }
}
