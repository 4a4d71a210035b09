// The interface for other languages against the templates that it is made of, and all that can go wrong in it.
#include <doctest/doctest.h>

#include <motionlang/c/motionlang_c.h>
#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/retarget.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>
#include <motionlang/stmc.hpp>

#include "../../support/rigs.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

const char* const timeline =
    "walk forward # 0 # 2 # legs\n"
    "raise both arms # 0.5 # 1.5 # left arm # right arm\n";

/// The bundled model, read once.
const motionlang_model* model() {
  static const std::unique_ptr<motionlang_model, void (*)(motionlang_model*)> read{
      [] {
        motionlang_model* m = nullptr;
        CHECK(motionlang_load_model(MOTIONLANG_BUNDLED_MODEL, &m) == 0);
        return m;
      }(),
      motionlang_free_model};
  return read.get();
}
/// Freed at the end of a test.
struct Made {
  motionlang_motion* motion = nullptr;
  Made() = default;
  Made(const Made&) = delete;
  Made& operator=(const Made&) = delete;
  ~Made() { motionlang_free_motion(motion); }
};
/// The numbers that `copy` gives, of which there are so many.
std::vector<float> numbers(int (*copy)(const motionlang_motion*, float*, int64_t), const Made& made, int64_t count) {
  std::vector<float> out(static_cast<std::size_t>(count));
  CHECK(copy(made.motion, out.data(), count) == 0);
  return out;
}
bool told(const char* part) { return std::string(motionlang_message()).find(part) != std::string::npos; }

}  // namespace

TEST_CASE("the motion is that of the templates, and so are all its numbers") {
  Made made;
  motionlang_options options = motionlang_default_options();
  options.seed = 3, options.steps = 5, options.guidance = 2;
  REQUIRE(motionlang_generate(model(), timeline, &options, &made.motion) == 0);

  const auto stmc = ml::load_stmc<ml::EigenBackend<float>>(MOTIONLANG_BUNDLED_MODEL);
  const auto texts = ml::cut_texts(ml::parse_timeline(timeline), stmc.fps);
  const auto features = stmc.generate(texts, ml::Philox{.seed = 3}, {.guidance = 2, .steps = 5});
  const ml::Motion want = ml::fix_feet(ml::smooth_motion(ml::stmc_motion(features)));

  CHECK(motionlang_model_fps(model()) == stmc.fps);
  CHECK(motionlang_fps(made.motion) == want.fps);
  REQUIRE(motionlang_frames(made.motion) == want.frames());
  REQUIRE(motionlang_joints(made.motion) == want.skeleton.size());
  for (int j = 0; j < want.skeleton.size(); ++j) {
    CHECK(motionlang_joint_name(made.motion, j) == want.skeleton.name(j));
    CHECK(motionlang_joint_parent(made.motion, j) == want.skeleton.parent(j));
  }
  CHECK(motionlang_joint_name(made.motion, -1) == nullptr);
  CHECK(motionlang_joint_name(made.motion, want.skeleton.size()) == nullptr);
  CHECK(motionlang_joint_parent(made.motion, want.skeleton.size()) == -1);

  const auto root = numbers(motionlang_root, made, std::ssize(want.root) * 3);
  const auto offsets = numbers(motionlang_offsets, made, std::ssize(want.skeleton.offsets) * 3);
  const auto rotations = numbers(motionlang_rotations, made, std::ssize(want.local) * 4);
  const auto positions = numbers(motionlang_positions, made, std::ssize(want.local) * 3);
  const auto expected = want.positions();
  double worst = 0;
  const auto compare = [&](double a, double b) { worst = std::max(worst, std::abs(a - b)); };
  for (std::size_t i = 0; i < want.root.size(); ++i)
    compare(root[3 * i + 1], want.root[i].y), compare(root[3 * i + 2], want.root[i].z);
  for (std::size_t i = 0; i < want.skeleton.offsets.size(); ++i) compare(offsets[3 * i], want.skeleton.offsets[i].x);
  for (std::size_t i = 0; i < want.local.size(); ++i) {
    compare(rotations[4 * i], want.local[i].w), compare(rotations[4 * i + 3], want.local[i].z);
    compare(positions[3 * i], expected[i].x), compare(positions[3 * i + 2], expected[i].z);
  }
  CHECK(worst < 1e-5);
}

TEST_CASE("each step of the finish can be left out") {
  motionlang_options options = motionlang_default_options();
  options.steps = 3;
  const auto positions = [&] {
    Made made;
    REQUIRE(motionlang_generate(model(), timeline, &options, &made.motion) == 0);
    return numbers(motionlang_positions, made, motionlang_frames(made.motion) * motionlang_joints(made.motion) * 3);
  };
  const auto all = positions();
  CHECK(positions() == all);  // same seed
  for (int32_t motionlang_options::*step :
       {&motionlang_options::cut_texts, &motionlang_options::smooth, &motionlang_options::fix_feet}) {
    options.*step = 0;
    CHECK(positions() != all);
    options.*step = 1;
  }
  options.seed = 1;
  CHECK(positions() != all);
}

TEST_CASE("a progress function is called after every step and may stop the work") {
  struct Calls {
    int64_t count = 0, last = 0, stop_at = 0;
  } calls;
  motionlang_options options = motionlang_default_options();
  options.steps = 4, options.user = &calls;
  options.progress = [](void* user, int64_t done, int64_t total) -> int32_t {
    auto& c = *static_cast<Calls*>(user);
    ++c.count, c.last = done;
    CHECK(total == 4);
    return done != c.stop_at;
  };
  Made made;
  CHECK(motionlang_generate(model(), timeline, &options, &made.motion) == 0);
  CHECK(calls.count == 4);
  CHECK(calls.last == 4);
  calls = {.stop_at = 2};
  Made stopped;
  CHECK(motionlang_generate(model(), timeline, &options, &stopped.motion) == MOTIONLANG_CANCELLED);
  CHECK(stopped.motion == nullptr);
  CHECK(calls.count == 2);
  CHECK(told("cancelled"));
}

TEST_CASE("files and characters") {
  const TemporaryFolder folder;
  const auto rig = (folder / "rig.glb").string(), out = (folder / "out.bvh").string();
  const auto mixamo = rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:");
  ml::write_file(rig, rigs::glb_of(mixamo));
  Made made, character, on_character, again;
  motionlang_options options = motionlang_default_options();
  options.steps = 3;
  REQUIRE(motionlang_generate(model(), timeline, &options, &made.motion) == 0);
  REQUIRE(motionlang_read_motion(rig.c_str(), &character.motion) == 0);
  REQUIRE(motionlang_retarget(made.motion, character.motion, &on_character.motion) == 0);
  CHECK(motionlang_frames(on_character.motion) == motionlang_frames(made.motion));
  CHECK(motionlang_joints(on_character.motion) == motionlang_joints(character.motion));
  for (const char* name : {"out.bvh", "out.glb", "out.html"}) {
    CHECK(motionlang_write_motion(on_character.motion, (folder / name).c_str()) == 0);
    CHECK(std::filesystem::file_size(folder / name) > 1000);
  }
  REQUIRE(motionlang_read_motion(out.c_str(), &again.motion) == 0);
  CHECK(motionlang_frames(again.motion) == motionlang_frames(made.motion));
  CHECK(motionlang_joints(again.motion) == motionlang_joints(on_character.motion));
}

TEST_CASE("what is wrong has an id and a message") {
  CHECK(std::string(motionlang_version()) == MOTIONLANG_VERSION);
  motionlang_model* no_model = nullptr;
  CHECK(motionlang_load_model("/nowhere/model.safetensors", &no_model) == 401);
  CHECK(told("/nowhere/model.safetensors"));
  CHECK(no_model == nullptr);
  CHECK(motionlang_load_model(nullptr, &no_model) == 101);
  CHECK(motionlang_load_model("x", nullptr) == 101);
  CHECK(told("model is NULL"));

  Made made;
  CHECK(motionlang_generate(nullptr, timeline, nullptr, &made.motion) == 101);
  CHECK(motionlang_generate(model(), nullptr, nullptr, &made.motion) == 101);
  CHECK(motionlang_generate(model(), timeline, nullptr, nullptr) == 101);
  CHECK(motionlang_generate(model(), "wave # 2 # 1\n", nullptr, &made.motion) == 504);
  CHECK(told("timeline:1:12"));
  CHECK(motionlang_generate(model(), "wave # 0 # 1\n\nwave # 0 # 1\n", nullptr, &made.motion) == 509);
  motionlang_options options = motionlang_default_options();
  options.steps = -1;
  CHECK(motionlang_generate(model(), timeline, &options, &made.motion) > 100);
  CHECK(made.motion == nullptr);

  CHECK(motionlang_read_motion("walk.fbx", &made.motion) == 103);
  CHECK(told("walk.fbx"));
  CHECK(motionlang_read_motion("/nowhere/walk.bvh", &made.motion) == 401);
  options = motionlang_default_options();
  options.steps = 1;
  REQUIRE(motionlang_generate(model(), "wave # 0 # 1\n", &options, &made.motion) == 0);
  CHECK(motionlang_write_motion(made.motion, "walk.fbx") == 103);
  CHECK(motionlang_write_motion(made.motion, "/nowhere/walk.bvh") == 401);
  CHECK(motionlang_write_motion(nullptr, "walk.bvh") == 101);
  motionlang_motion* none = nullptr;
  CHECK(motionlang_retarget(made.motion, nullptr, &none) == 101);
  std::vector<float> room(7);
  CHECK(motionlang_root(made.motion, room.data(), 7) == 205);
  CHECK(told("room for 7 floats, there are 60"));
  CHECK(motionlang_root(made.motion, nullptr, 60) == 101);
  CHECK(motionlang_root(nullptr, room.data(), 7) == 101);

  CHECK(motionlang_frames(nullptr) == 0);
  CHECK(motionlang_joints(nullptr) == 0);
  CHECK(motionlang_fps(nullptr) == 0);
  CHECK(motionlang_model_fps(nullptr) == 0);
  CHECK(motionlang_joint_name(nullptr, 0) == nullptr);
  CHECK(motionlang_set_threads(0) == 101);
  CHECK(motionlang_set_threads(2) == 0);
  motionlang_free_model(nullptr);
  motionlang_free_motion(nullptr);
}
