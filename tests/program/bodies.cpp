// motionlang convert, view and strip: the user's body with the hands and the shape of AMASS files, its files merged;
// whole folders.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/formats/amass_body.hpp>
#include <motionlang/formats/body_file.hpp>
#include <motionlang/formats/body_glb.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

#include "../support/octahedra_body.hpp"
#include "../support/official_vaes.hpp"
#include "../support/synthetic_body.hpp"
#include "../support/synthetic_motion.hpp"
#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

namespace {

/// Bodies of three kinds, AMASS files with and without hands, and a walk.
struct Wardrobe : TemporaryFolder {
  Wardrobe() {
    ml::write_npz(*this / "smpl.npz", octahedra::arrays());
    ml::write_npz(*this / "smplh.npz", octahedra::arrays(ml::BodyKind::smplh));
    ml::write_npz(*this / "smplx.npz", octahedra::arrays(ml::BodyKind::smplx));
    amass("moving.npz", 165, {0.5, 0, -2});
    amass("hands.npz", 156, {0, 0, 0});
    ml::write_amass(*this / "plain.npz", walk());
  }
  static ml::Motion walk() { return synthetic::walk({.frames = 5}); }
  void amass(const char* file, ml::Index columns, const std::vector<double>& betas) const {
    const auto array = [](const std::vector<double>& values, std::vector<ml::Index> shape) {
      return ml::NpyArray::of(std::span<const double>(values), std::move(shape));
    };
    ml::write_npz(*this / file, std::vector<ml::NamedArray>{
                                    {"poses", array(synthetic::wave(2, static_cast<int>(2 * columns)), {2, columns})},
                                    {"trans", array({1, 2, 3, -0.5, 0, 0.9}, {2, 3})},
                                    {"betas", array(betas, {std::ssize(betas)})},
                                    {"gender", ml::NpyArray::text("female")},
                                    {"mocap_framerate", ml::NpyArray::scalar(30.0)}});
  }
  std::string convert(const std::string& in, const std::string& out, std::vector<std::string> more) const {
    more.insert(more.begin(), {"convert", in, out});
    const Outcome o = ::run(more, path);
    CHECK_MESSAGE(o.code == 0, o.text);
    return o.text;
  }
  Outcome run(const std::vector<std::string>& arguments) const { return ::run(arguments, path); }
  std::string text(const std::string& file) const { return ml::read_file(*this / file); }
  ml::Motion glb(const std::string& file) const { return ml::GlbFile::open(*this / file).motion(0, 30); }
};

ml::Quaternion<double> rotation(const ml::Motion& m, const char* joint) {
  return m.rotations(1)[static_cast<std::size_t>(m.skeleton[joint])];
}

}  // namespace

TEST_CASE("convert: hands, face and shape of an AMASS file are on the body, and what it does not have is reported") {
  const Wardrobe w;
  CHECK(contains(
      w.convert("moving.npz", "x.obj", {"--body", "smplx.npz"}),
      "moving.npz on SMPL-X: left hand, right hand, jaw and eyes, betas 1 to 1 (female); left out: betas 2 to 3\n"));
  CHECK(contains(
      w.convert("moving.npz", "h.obj", {"--body", "smplh.npz"}),
      "moving.npz on SMPL-H: left hand, right hand; left out: jaw and eyes, betas, which are of other shapes\n"));
  CHECK(contains(w.convert("hands.npz", "s.obj", {"--body", "smpl.npz"}),
                 "hands.npz on SMPL: left out: left hand, right hand\n"));
  CHECK(!contains(w.convert("plain.npz", "p.obj", {"--body", "smplh.npz"}), "plain.npz on"));
  CHECK(!contains(w.convert("hands.npz", "f.obj", {"--body", "free"}), "left out"));

  // the vertices are those of the library, and of the model: unit/formats/amass_body.cpp
  const auto body = ml::read_body<B>(w / "smplx.npz", {.betas = 1});
  const auto clip = ml::amass_on_body(ml::read_amass_sequence(w / "moving.npz"), "moving", body);
  ml::write_body_objs(w / "expected.obj", body, clip.motion, std::span<const float>(clip.betas));
  for (const std::string frame : {"0000", "0001"})
    CHECK(w.text("x_" + frame + ".obj") == w.text("expected_" + frame + ".obj"));

  // another shape is the user's to give
  const std::string own = w.convert("moving.npz", "own.obj", {"--body", "smplx.npz", "--betas=0.5"});
  CHECK(!contains(own, "betas"));
  CHECK(w.text("own_0001.obj") == w.text("x_0001.obj"));
  w.convert("moving.npz", "own.obj", {"--body", "smplx.npz", "--betas=0"});
  CHECK(w.text("own_0001.obj") != w.text("x_0001.obj"));
  const Outcome many = w.run({"convert", "moving.npz", "own.obj", "--body", "smplx.npz", "--betas=0,1"});
  CHECK(many.code == 1);
  CHECK_MESSAGE(contains(many.text, "[motionlang.config.101]"), many.text);
}

TEST_CASE("convert and view: hands stay on the body when the motion is edited") {
  const Wardrobe w;
  w.convert("hands.npz", "hands.glb", {"--body", "smplh.npz"});
  w.convert("hands.npz", "mirrored.glb", {"--body", "smplh.npz", "--mirror", "--fix-feet", "--smpl"});
  const auto hands = w.glb("hands.glb"), mirrored = w.glb("mirrored.glb");
  CHECK(hands.skeleton.size() == 52);
  const auto sequence = ml::read_amass_sequence(w / "hands.npz");
  CHECK(ml::distance(rotation(hands, "left_index1"), ml::detail::amass_rotation(sequence, 1, 22)) < 1e-3);
  CHECK(ml::distance(rotation(hands, "right_thumb3"), ml::detail::amass_rotation(sequence, 1, 51)) < 1e-3);
  const auto q = rotation(hands, "left_index1");
  CHECK(ml::distance(rotation(mirrored, "right_index1"), ml::Quaternion<double>{q.w, q.x, -q.y, -q.z}) < 1e-3);

  official::write_actor_run(w / "actor", official::small_actor());
  const std::vector<std::string> denoised{"--body", "smplh.npz", "--denoise", "actor", "--action", "walk"};
  const std::string without = "what --denoise makes is without hands and face";
  CHECK(contains(w.convert("hands.npz", "clean.glb", denoised), "hands.npz: " + without));
  CHECK(!contains(w.convert("plain.npz", "clean.glb", denoised), without));

  const Outcome page = w.run({"view", "hands.npz", "--body", "smpl.npz"});
  CHECK_MESSAGE(page.code == 0, page.text);
  CHECK(contains(page.text, "left out: left hand, right hand"));
  CHECK(contains(w.text("hands.npz.html"), "\"triangles\""));
}

TEST_CASE("convert: a body of SMPL-H gets the hands of MANO") {
  const Wardrobe w;
  const auto mano = [&](const char* file, double bend) {
    const std::vector<double> mean(45, bend), components(90, 1);
    ml::write_npz(w / file, std::vector<ml::NamedArray>{
                                {"hands_components", ml::NpyArray::of(std::span<const double>(components), {2, 45})},
                                {"hands_mean", ml::NpyArray::of(std::span<const double>(mean), {45})}});
  };
  mano("left.npz", 0.1);
  mano("right.npz", 0.2);
  CHECK(contains(w.convert("smplh.npz", "SMPLH.npz", {"--hands", "left.npz", "right.npz"}),
                 "SMPLH.npz: the body of smplh.npz with the hands of left.npz and right.npz"));
  const auto body = ml::read_body<B>(w / "SMPLH.npz", {.betas = 1});
  REQUIRE((body.left_hand && body.right_hand));
  CHECK(body.left_hand->mean.span()[44] == 0.1F);
  CHECK(body.right_hand->mean.span()[0] == 0.2F);
  w.convert("plain.npz", "walk.glb", {"--body", "SMPLH.npz"});  // has no hands of its own
  CHECK(ml::distance(rotation(w.glb("walk.glb"), "left_ring2"), ml::AxisAngle<double>{{0.1, 0.1, 0.1}}) < 1e-3);

  const std::vector<std::pair<std::vector<std::string>, std::string>> refused{
      {{"smpl.npz", "out.npz", "--hands", "left.npz", "right.npz"}, "a body of 24 joints; hands belong to SMPL-H"},
      {{"smplh.npz", "out.npz", "--hands", "smplh.npz", "right.npz"}, "no 'hands_components'; not a hand of MANO"},
      {{"smplh.npz", "out.pkl", "--hands", "left.npz", "right.npz"},
       "[motionlang.config.103] out.pkl: a body is written to .npz"},
      {{"smplh.npz", "out.npz", "--hands", "left.npz"}, "--hands"},
      {{"smplh.npz", "out.npz", "--hands", "left.npz", "right.npz", "--mirror"}, "--hands excludes --mirror"}};
  for (auto [arguments, message] : refused) {
    arguments.insert(arguments.begin(), "convert");
    const Outcome out = w.run(arguments);
    CHECK(out.code != 0);
    CHECK_MESSAGE(contains(out.text, message), out.text);
    CHECK(!std::filesystem::exists(w / "out.npz"));
  }
}

TEST_CASE("convert, strip: bodies of a folder as .obj files, film strips as .png") {
  const Wardrobe w;
  std::filesystem::create_directories(w / "in/deep");
  ml::write_bvh(w / "in/walk.bvh", Wardrobe::walk());
  std::vector<ml::Motion> two(2, Wardrobe::walk());
  two[1].name = "again";
  ml::write_glb(w / "in/deep/two.glb", two);
  std::filesystem::copy_file(w / "moving.npz", w / "in/moving.npz");
  CHECK(contains(w.convert("in", "out", {"--as", ".obj", "--body", "smplh.npz"}), "out: 3 of 3 files converted"));
  for (const char* file :
       {"out/walk_0004.obj", "out/moving_0001.obj", "out/deep/two_walk_0000.obj", "out/deep/two_again_0000.obj"})
    CHECK_MESSAGE(w.text(file).starts_with("v "), file);
  w.convert("moving.npz", "alone.obj", {"--body", "smplh.npz"});
  CHECK(w.text("out/moving_0001.obj") == w.text("alone_0001.obj"));  // its own shape and hands
  const Outcome bare = w.run({"convert", "in", "out", "--as", ".obj"});
  CHECK(bare.code == 2);
  CHECK_MESSAGE(contains(bare.text, ".obj files show a body: name it with --body"), bare.text);

  const Outcome strips = w.run({"strip", "in", "-o", "strips", "--as", ".png"});
  CHECK_MESSAGE(strips.code == 0, strips.text);
  for (const char* file : {"strips/walk.png", "strips/deep/two_walk.png"})
    CHECK_MESSAGE(w.text(file).starts_with("\x89PNG"), file);
  CHECK(w.run({"strip", "in", "--as", ".bvh"}).code == 2);
  CHECK(w.run({"strip", "in/walk.bvh", "--as", ".png"}).code == 2);
}
