// The interface for other languages against the templates that it is made of, and all that can go wrong in it.
#include <doctest/doctest.h>

#include <motionlang/c/motionlang_c.h>
#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/features_npy.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/generate/finish_motion.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/retarget.hpp>
#include <motionlang/stmc.hpp>

#include "../../support/rigs.hpp"
#include "../../support/synthetic_motion.hpp"
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
  options.seed = 3, options.steps = 5, options.guidance = 2, options.overlay_arms = 0;
  REQUIRE(motionlang_generate(model(), timeline, &options, &made.motion) == 0);

  const auto stmc = ml::load_stmc<ml::EigenBackend<float>>(MOTIONLANG_BUNDLED_MODEL);
  const auto texts = ml::cut_texts(ml::parse_timeline(timeline), stmc.fps);
  const auto features = stmc.generate(texts, ml::Philox{.seed = 3}, {.guidance = 2, .steps = 5});
  const ml::Motion want = ml::finish_motion(ml::stmc_motion(features), {});

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
  options.steps = 4, options.user = &calls, options.overlay_arms = 0;
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

  const motionlang_motion* const both[] = {made.motion, made.motion};
  const auto added = (folder / "added.glb").string(), page = (folder / "page.html").string();
  REQUIRE(motionlang_write_on_character(both, 2, rig.c_str(), nullptr, added.c_str()) == 0);
  motionlang_motions* animations = nullptr;
  REQUIRE(motionlang_read_motions(added.c_str(), nullptr, &animations) == 0);
  REQUIRE(motionlang_motions_count(animations) == 3);  // and that of the character
  CHECK(motionlang_joints(motionlang_motions_at(animations, 2)) == motionlang_joints(character.motion));
  motionlang_free_motions(animations);
  CHECK(motionlang_write_on_character(both, 1, rig.c_str(), nullptr, page.c_str()) == 0);
  CHECK(std::filesystem::file_size(page) > 1000);
  CHECK(motionlang_write_on_character(both, 1, rig.c_str(), nullptr, out.c_str()) == 103);
  CHECK(motionlang_write_on_character(both, 0, rig.c_str(), nullptr, added.c_str()) == 103);
  CHECK(motionlang_write_on_character(both, 1, "", nullptr, added.c_str()) == 101);
  CHECK(motionlang_write_on_character(both, 1, nullptr, nullptr, added.c_str()) == 101);
}

TEST_CASE("features are those of the templates") {
  const TemporaryFolder folder;
  const auto bvh = (folder / "walk.bvh").string(), npy = (folder / "walk.npy").string();
  const ml::Motion walk = synthetic::walk({.frames = 40});
  ml::write_bvh(bvh, walk);
  Made read;
  REQUIRE(motionlang_read_motion(bvh.c_str(), &read.motion) == 0);
  REQUIRE(motionlang_write_features(read.motion, "guoh3d", npy.c_str()) == 0);
  const std::string by_c = ml::read_file(npy);
  ml::write_features_npy(npy, ml::read_motion(bvh), ml::motion_features("guoh3d"));
  CHECK(by_c == ml::read_file(npy));
  CHECK(motionlang_write_features(read.motion, "dance", npy.c_str()) == 103);
  CHECK(motionlang_write_features(nullptr, "guoh3d", npy.c_str()) == 101);
  CHECK(motionlang_write_features(read.motion, "guoh3d", "/nowhere/walk.npy") == 401);
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
  CHECK(motionlang_load_model_with(nullptr, nullptr, nullptr, &no_model) == 101);
  CHECK(motionlang_load_model_with(MOTIONLANG_BUNDLED_MODEL, "clip", nullptr, &no_model) == 102);
  CHECK(told("this one has its own"));
  CHECK(no_model == nullptr);

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

namespace {

struct Several {
  motionlang_motions* motions = nullptr;
  Several() = default;
  Several(const Several&) = delete;
  Several& operator=(const Several&) = delete;
  ~Several() { motionlang_free_motions(motions); }
};

}  // namespace

TEST_CASE("several timelines become several motions") {
  motionlang_options options = motionlang_default_options();
  options.seed = 5, options.steps = 3;
  Several two;
  REQUIRE(motionlang_generate_motions(model(), "walk # 0 # 1\n\nsit down # 0 # 2\n", &options, &two.motions) == 0);
  CHECK(motionlang_motions_count(two.motions) == 2);
  Made first;
  REQUIRE(motionlang_generate(model(), "walk # 0 # 1\n", &options, &first.motion) == 0);
  const motionlang_motion* same = motionlang_motions_at(two.motions, 0);
  CHECK(motionlang_frames(same) == 20);
  CHECK(motionlang_frames(motionlang_motions_at(two.motions, 1)) == 40);
  std::vector<float> a(60), b(60);
  CHECK(motionlang_root(same, a.data(), 60) == 0);
  CHECK(motionlang_root(first.motion, b.data(), 60) == 0);
  CHECK(a == b);
  CHECK(motionlang_generate_motions(model(), "walk # 2 # 1\n", &options, &two.motions) == 504);
}

TEST_CASE("every format is read and written, from files and from memory") {
  const TemporaryFolder folder;
  const ml::Motion walk = synthetic::walk({.frames = 20});
  const std::string bvh = (folder / "walk.bvh").string();
  ml::write_bvh(bvh, walk);
  Made read;
  REQUIRE(motionlang_read_motion(bvh.c_str(), &read.motion) == 0);
  CHECK(std::string(motionlang_motion_name(read.motion)) == "walk");
  for (const char* kind : {".bvh", ".glb", ".npz", ".npy", ".html", ".svg", ".png"}) {
    CAPTURE(kind);
    const std::string file = (folder / (std::string("a") + kind)).string();
    CHECK(motionlang_write_motion(read.motion, file.c_str()) == 0);
    motionlang_bytes* bytes = nullptr;
    REQUIRE(motionlang_motion_bytes(read.motion, kind, &bytes) == 0);
    const std::string contents = ml::read_file(file);
    CHECK(std::string_view(static_cast<const char*>(motionlang_bytes_data(bytes)),
                           static_cast<std::size_t>(motionlang_bytes_size(bytes))) == contents);
    motionlang_free_bytes(bytes);
    if (!ml::is_motion_file(file)) continue;
    Several from_file, from_memory;
    REQUIRE(motionlang_read_motions(file.c_str(), nullptr, &from_file.motions) == 0);
    REQUIRE(motionlang_parse_motions(contents.data(), std::ssize(contents), file.c_str(), nullptr,
                                     &from_memory.motions) == 0);
    CHECK(motionlang_frames(motionlang_motions_at(from_memory.motions, 0)) == 20);
    CHECK(motionlang_motions_count(from_file.motions) == 1);
    CHECK(motionlang_frames(motionlang_motions_at(from_file.motions, 0)) == 20);
    CHECK(std::string(motionlang_motions_notes(from_file.motions)).empty());
  }
  const motionlang_motion* both[] = {read.motion, read.motion};
  const std::string glb = (folder / "both.glb").string();
  CHECK(motionlang_write_motions(both, 2, glb.c_str()) == 0);
  Several again;
  motionlang_read_options options = motionlang_default_read_options();
  options.fps = 10;
  REQUIRE(motionlang_read_motions(glb.c_str(), &options, &again.motions) == 0);
  CHECK(motionlang_motions_count(again.motions) == 2);
  CHECK(motionlang_fps(motionlang_motions_at(again.motions, 1)) == 10);
  CHECK(motionlang_motions_at(again.motions, 2) == nullptr);

  float height[2] = {};  // of the head over the pelvis, and of the pelvis over the head with -Y up
  for (const int up : {0, -'y'}) {
    Several turned;
    options.up = up;
    REQUIRE(motionlang_read_motions(glb.c_str(), &options, &turned.motions) == 0);
    const motionlang_motion* m = motionlang_motions_at(turned.motions, 0);
    std::vector<float> places(static_cast<std::size_t>(3 * motionlang_frames(m) * motionlang_joints(m)));
    REQUIRE(motionlang_positions(m, places.data(), std::ssize(places)) == 0);
    height[up == 0 ? 0 : 1] = places[3 * 15 + 1] - places[1];
  }
  CHECK(height[0] > 0.3);
  CHECK(height[1] == doctest::Approx(-height[0]));
  for (const int up : {+'x', +'y', +'z', -'x', -'z'}) {
    options.up = up;
    CHECK(motionlang_read_motions(glb.c_str(), &options, &again.motions) == 0);
    motionlang_free_motions(std::exchange(again.motions, nullptr));
  }
  options.up = 'w';
  CHECK(motionlang_read_motions(glb.c_str(), &options, &again.motions) == 103);
  CHECK(motionlang_read_motions(nullptr, nullptr, &again.motions) == 101);
  CHECK(motionlang_parse_motions(nullptr, 3, "a.bvh", nullptr, &again.motions) == 101);
  CHECK(motionlang_parse_motions("x", -1, "a.bvh", nullptr, &again.motions) == 101);
  CHECK(motionlang_write_motions(both, 2, "a.bvh") == 103);
  CHECK(motionlang_write_motions(nullptr, 2, "a.glb") == 101);
  CHECK(motionlang_write_motions(both, -1, "a.glb") == 101);
  motionlang_bytes* none = nullptr;
  CHECK(motionlang_motion_bytes(read.motion, ".fbx", &none) == 103);
  CHECK(motionlang_bytes_data(nullptr) == nullptr);
  CHECK(motionlang_bytes_size(nullptr) == 0);
  CHECK(motionlang_motions_count(nullptr) == 0);
  CHECK(std::string(motionlang_motions_notes(nullptr)).empty());
  CHECK(std::string(motionlang_motion_name(nullptr)).empty());
  motionlang_free_motions(nullptr);
  motionlang_free_bytes(nullptr);
}

TEST_CASE("an editor checks a timeline and draws a motion") {
  const auto text_of = [](motionlang_bytes* bytes) {
    const std::string out(static_cast<const char*>(motionlang_bytes_data(bytes)),
                          static_cast<std::size_t>(motionlang_bytes_size(bytes)));
    motionlang_free_bytes(bytes);
    return out;
  };
  motionlang_bytes* json = nullptr;
  REQUIRE(motionlang_check_timeline(model(), timeline, &json) == 0);
  CHECK(text_of(json).starts_with(
      R"({"fps":20.0,"seconds":2.0,"texts":[{"text":"walk forward","start":0.0,"end":2.0,"parts":["legs"]},)"));
  REQUIRE(motionlang_check_timeline(model(), "walk forwad # 0 # 2\n", &json) == 0);
  CHECK(text_of(json).find(R"("warnings":[{"texts":[0],"message":"'walk forwad')") != std::string::npos);
  CHECK(motionlang_check_timeline(model(), "walk # 0\n", &json) != 0);
  CHECK(told("timeline:1:"));
  CHECK(motionlang_check_timeline(nullptr, timeline, &json) == 101);
  CHECK(motionlang_check_timeline(model(), nullptr, &json) == 101);

  const TemporaryFolder folder;
  const std::string file = (folder / "walk.bvh").string();
  ml::write_bvh(file, synthetic::walk({.frames = 20}));
  Made read;
  REQUIRE(motionlang_read_motion(file.c_str(), &read.motion) == 0);
  REQUIRE(motionlang_viewer_data(read.motion, &json) == 0);
  CHECK(text_of(json).find(R"("frames":20,)") != std::string::npos);
  CHECK(motionlang_viewer_data(nullptr, &json) == 101);
  CHECK(json == nullptr);
}

TEST_CASE("an edited timeline keeps what is far from the edit") {
  const TemporaryFolder folder;
  const auto first = (folder / "first").string(), second = (folder / "second").string();
  motionlang_options options = motionlang_default_options();
  options.steps = 5, options.seed = 7, options.record = first.c_str();
  Made before, same, after, whole;
  const char* const old = "walk forward # 0 # 4\nraise both arms # 4 # 6\nwalk forward # 6 # 12\n";
  const char* const edited = "walk forward # 0 # 4\nsit down # 4 # 6\nwalk forward # 6 # 12\n";
  REQUIRE(motionlang_generate(model(), old, &options, &before.motion) == 0);
  CHECK(motionlang_motion_reuse(before.motion).frames == 0);
  options = motionlang_default_options();
  options.reuse = first.c_str();
  REQUIRE(motionlang_generate(model(), old, &options, &same.motion) == 0);
  const motionlang_reuse none_new = motionlang_motion_reuse(same.motion);
  CHECK(none_new.frames == 240);
  CHECK(none_new.kept == 240);
  CHECK(none_new.work == 0);
  CHECK(none_new.whole_work > 0);
  CHECK(none_new.exact == 1);
  options.record = second.c_str(), options.keep_beyond = 1;
  REQUIRE(motionlang_generate(model(), edited, &options, &after.motion) == 0);
  const motionlang_reuse some = motionlang_motion_reuse(after.motion);
  CHECK(some.kept == 240 - 20 * 2 - 2 * (20 + 5));  // the edit, a second and half the overlap on each side
  CHECK(some.work > 0);
  CHECK(some.work <= some.whole_work);
  CHECK(some.exact == 0);
  CHECK(std::filesystem::exists(second));
  const auto values = [&](const Made& of) {
    return numbers(motionlang_rotations, of, motionlang_frames(of.motion) * motionlang_joints(of.motion) * 4);
  };
  const std::vector<float> a = values(before), b = values(after), c = values(same);
  REQUIRE(a.size() == b.size());
  CHECK(a == c);
  const auto trunk = [&](const std::vector<float>& all,
                         std::size_t frame) {  // spine, head and arms, which no foot moves
    std::vector<float> out;
    for (const std::size_t joint : {3u, 6u, 9u, 12u, 13u, 14u, 15u, 16u, 17u, 18u, 19u, 20u, 21u, 22u, 23u}) {
      const auto at = all.begin() + static_cast<std::ptrdiff_t>(4 * (frame * 24 + joint));
      out.insert(out.end(), at, at + 4);
    }
    return out;
  };
  REQUIRE(motionlang_joints(before.motion) == 24);
  for (std::size_t f = 0; f < 240; ++f) {
    if (f < 40 || f >= 160) CHECK_MESSAGE(trunk(a, f) == trunk(b, f), f);
  }
  CHECK(trunk(a, 100) != trunk(b, 100));
  CHECK(motionlang_motion_reuse(nullptr).frames == 0);
}

TEST_CASE("a stretch of a motion is kept at another time") {
  const TemporaryFolder folder;
  const std::string file = (folder / "walk.bvh").string();
  ml::write_bvh(file, synthetic::walk({.frames = 60}));
  Made read, cut, none;
  REQUIRE(motionlang_read_motion(file.c_str(), &read.motion) == 0);
  const double fps = motionlang_fps(read.motion), length = 60 / fps;
  REQUIRE(motionlang_cut_motion(read.motion, length / 3, length, 1, &cut.motion) == 0);
  REQUIRE(motionlang_frames(cut.motion) == 40 + static_cast<int64_t>(std::llround(fps)));
  const auto lead = static_cast<std::size_t>(std::llround(fps));
  const auto all = numbers(motionlang_root, read, 60 * 3);
  const auto part = numbers(motionlang_root, cut, motionlang_frames(cut.motion) * 3);
  for (std::size_t f = 0; f < 40 + lead; ++f) CHECK(part[3 * f + 2] == all[3 * (20 + (f < lead ? 0 : f - lead)) + 2]);
  CHECK(motionlang_cut_motion(read.motion, 1, 0.5, 0, &none.motion) == 101);
  CHECK(motionlang_cut_motion(read.motion, 0, length + 2, 0, &none.motion) == 101);
  CHECK(motionlang_cut_motion(read.motion, 0, 1, -1, &none.motion) == 101);
  CHECK(motionlang_cut_motion(read.motion, 0, 0, 0, &none.motion) == 203);
  CHECK(motionlang_cut_motion(nullptr, 0, 1, 0, &none.motion) == 101);

  motionlang_options options = motionlang_default_options();
  const double kept[] = {1, 2};
  options.steps = 3, options.keep = cut.motion, options.keep_seconds = kept, options.keep_stretches = 1;
  Made made;
  CHECK(motionlang_generate(model(), "walk forward # 0 # 3\n", &options, &made.motion) == 0);
  CHECK(motionlang_frames(made.motion) == 60);
}

TEST_CASE("an editor offers the texts that the model knows") {
  motionlang_bytes* json = nullptr;
  REQUIRE(motionlang_known_texts(model(), "walk", 5, &json) == 0);
  const std::string texts(static_cast<const char*>(motionlang_bytes_data(json)),
                          static_cast<std::size_t>(motionlang_bytes_size(json)));
  motionlang_free_bytes(json);
  CHECK(texts.starts_with(R"([{"text":"walk)"));
  CHECK(texts.find(R"("seconds":)") != std::string::npos);
  CHECK(motionlang_known_texts(model(), nullptr, 0, &json) == 0);
  CHECK(motionlang_bytes_size(json) == 2);
  motionlang_free_bytes(json);
  CHECK(motionlang_known_texts(nullptr, "walk", 5, &json) == 101);
}

TEST_CASE("a motion is drawn on a character in memory") {
  const TemporaryFolder folder;
  const std::string file = (folder / "walk.bvh").string();
  ml::write_bvh(file, synthetic::walk({.frames = 20}));
  Made read;
  REQUIRE(motionlang_read_motion(file.c_str(), &read.motion) == 0);
  const auto rig = rigs::glb_of(rigs::skeleton_of(ml::skeleton_table("Mixamo"), 0, 1, {}, "mixamorig:"));
  const auto size = static_cast<int64_t>(rig.size());
  motionlang_bytes* json = nullptr;
  REQUIRE(motionlang_viewer_data_on(read.motion, rig.data(), size, "rig.vrm", &json) == 0);
  const std::string data(static_cast<const char*>(motionlang_bytes_data(json)),
                         static_cast<std::size_t>(motionlang_bytes_size(json)));
  motionlang_free_bytes(json);
  CHECK(data.starts_with(R"({"motion":{)"));
  CHECK(data.find(R"("body":{"positions":)") != std::string::npos);
  CHECK(motionlang_viewer_data_on(read.motion, rig.data(), 10, "rig.vrm", &json) != 0);
  CHECK(told("rig.vrm"));
  CHECK(motionlang_viewer_data_on(nullptr, rig.data(), size, "rig.vrm", &json) == 101);
  CHECK(motionlang_viewer_data_on(read.motion, rig.data(), size, nullptr, &json) == 101);
}

TEST_CASE("an index is made, updated and searched by words and by a motion") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "clips");
  ml::write_bvh(folder / "clips/walk.bvh", synthetic::walk({.frames = 80}));
  ml::write_bvh(folder / "clips/jump.bvh", synthetic::jump());
  const std::string clips = (folder / "clips").string(), file = (folder / "moves.index").string();
  struct Calls {
    int64_t count = 0, total = 0;
    int32_t go_on = 1;
  } calls;
  motionlang_index_options options = motionlang_default_index_options();
  CHECK(motionlang_update_index(file.c_str(), clips.c_str(), &options, nullptr) == 101);  // no model
  CHECK(told("model of a new index is NULL"));
  options.model = MOTIONLANG_BUNDLED_TMR, options.license = "CC0", options.user = &calls;
  options.progress = [](void* user, int64_t, int64_t total) -> int32_t {
    auto& c = *static_cast<Calls*>(user);
    ++c.count, c.total = total;
    return c.go_on;
  };
  motionlang_index_report report{};
  REQUIRE(motionlang_update_index(file.c_str(), clips.c_str(), &options, &report) == 0);
  CHECK(report.clips == 2);
  CHECK(report.added == 2);
  CHECK(calls.count == 1);
  CHECK(calls.total == 2);
  REQUIRE(motionlang_update_index(file.c_str(), clips.c_str(), nullptr, &report) == 0);
  CHECK(report.unchanged == 2);
  CHECK(report.added == 0);
  options.again = 1, calls.go_on = 0;
  CHECK(motionlang_update_index(file.c_str(), clips.c_str(), &options, &report) == MOTIONLANG_CANCELLED);
  CHECK(report.clips == 2);

  motionlang_index* index = nullptr;
  REQUIRE(motionlang_open_index(file.c_str(), nullptr, nullptr, &index) == 0);
  CHECK(motionlang_index_clips(index) == 2);
  motionlang_hits* hits = nullptr;
  REQUIRE(motionlang_search_text(index, "a person walks forward", nullptr, &hits) == 0);
  REQUIRE(motionlang_hits_count(hits) == 2);
  motionlang_hit best{}, second{};
  CHECK(motionlang_hits_at(hits, 0, &best) == 0);
  CHECK(motionlang_hits_at(hits, 1, &second) == 0);
  CHECK(std::string(best.path).ends_with("walk.bvh"));
  CHECK(std::string(best.license) == "CC0");
  CHECK(std::string(best.caption).empty());
  CHECK(std::string(best.name).empty());
  CHECK(best.score > second.score);
  CHECK(best.end == doctest::Approx(4));
  CHECK(motionlang_hits_at(hits, 2, &best) == 203);
  CHECK(motionlang_hits_shown(hits) == 1);
  CHECK(std::string(motionlang_hits_unknown_words(hits)).empty());
  motionlang_free_hits(hits);

  Made jump;
  REQUIRE(motionlang_read_motion((folder / "clips/jump.bvh").string().c_str(), &jump.motion) == 0);
  motionlang_search_options how = motionlang_default_search_options();
  how.top = 3, how.what = MOTIONLANG_SEARCH_MOMENTS;
  REQUIRE(motionlang_search_motion(index, jump.motion, &how, &hits) == 0);
  CHECK(motionlang_hits_count(hits) == 3);
  CHECK(motionlang_hits_shown(hits) == 1);  // motions are not compared with texts
  motionlang_hit moment{};
  REQUIRE(motionlang_hits_at(hits, 0, &moment) == 0);
  double stretch[2] = {};
  for (const double margin : {0.0, 0.5}) {
    Made piece;
    REQUIRE(motionlang_hits_motion(hits, 0, margin, stretch, &piece.motion) == 0);
    CHECK(stretch[1] - stretch[0] == doctest::Approx(moment.end - moment.start).epsilon(0.05));
    const double seconds = static_cast<double>(motionlang_frames(piece.motion)) / motionlang_fps(piece.motion);
    CHECK(seconds <= moment.end - moment.start + 2 * margin + 0.1);
    CHECK(stretch[0] <= margin + 1e-9);
  }
  Made none;
  CHECK(motionlang_hits_motion(hits, 0, 0, nullptr, &none.motion) == 0);
  motionlang_free_motion(none.motion);
  CHECK(motionlang_hits_motion(hits, 3, 0, stretch, &none.motion) == 203);
  CHECK(motionlang_hits_motion(hits, 0, -1, stretch, &none.motion) == 101);
  CHECK(none.motion == nullptr);
  motionlang_free_hits(hits);
  how.what = 7;
  CHECK(motionlang_search_text(index, "x", &how, &hits) == 103);
  CHECK(motionlang_search_text(index, nullptr, nullptr, &hits) == 101);
  CHECK(motionlang_search_text(nullptr, "x", nullptr, &hits) == 101);
  CHECK(hits == nullptr);
  motionlang_free_index(index);

  CHECK(motionlang_open_index("/nowhere/moves.index", nullptr, nullptr, &index) == 401);
  CHECK(motionlang_open_index(file.c_str(), "/nowhere", nullptr, &index) == 401);
  CHECK(index == nullptr);
  CHECK(motionlang_index_clips(nullptr) == 0);
  CHECK(motionlang_hits_count(nullptr) == 0);
  CHECK(motionlang_hits_shown(nullptr) == 0);
  CHECK(std::string(motionlang_hits_unknown_words(nullptr)).empty());
  motionlang_free_index(nullptr);
  motionlang_free_hits(nullptr);
}
