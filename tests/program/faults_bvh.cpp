// BVH files that people sent, as the program's user meets them: notes, other axes, names, thousands of joints.
#include <doctest/doctest.h>

#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/formats/motion_file.hpp>

#include "../support/synthetic_motion.hpp"
#include "../support/tests_folder.hpp"
#include "small_workplace.hpp"

namespace {

const std::filesystem::path faults = std::filesystem::path(tests_folder()) / "unit/formats/data";

/// A workplace with such a file as in.bvh.
struct Case : Workplace {
  explicit Case(const std::string& name) { std::filesystem::copy_file(faults / (name + ".bvh"), *this / "in.bvh"); }
};

ml::Vec3<double> travel(const ml::Motion& m) { return m.root.back() - m.root.front(); }

}  // namespace

TEST_CASE("IK bones beside the pelvis: the walk is in .npz, in .bvh and on a character") {
  const Case c("bvh_root_with_ik_bones");
  std::filesystem::copy_file(faults / "bvh_root_with_ik_bones.glb", c / "rig.glb");
  for (const auto& arguments : {std::vector<std::string>{"convert", "in.bvh", "out.npz"},
                                {"convert", "in.bvh", "out.bvh"},
                                {"convert", "in.bvh", "out.glb", "--rig", "rig.glb"}}) {
    const auto out = c.run(arguments);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    CHECK_MESSAGE(contains(out.text, "left out: 'ik_foot_root' beside 'pelvis', the root of the body"), out.text);
    CHECK_MESSAGE(!contains(out.text, "away from the joint before"), out.text);
  }
  CHECK(ml::norm(travel(ml::read_motion(c / "out.npz")) - ml::Vec3<double>{0.1237, 0, 0.7419}) < 2e-4);
  CHECK(ml::norm(travel(ml::read_bvh_motion(c / "out.bvh")) - ml::Vec3<double>{0.126667, 0, 0.76}) < 1e-5);
  CHECK(ml::norm(travel(ml::read_glb(c / "out.glb", {.animation = "in"})) - ml::Vec3<double>{0.1267, 0, 0.76}) < 2e-4);
}

TEST_CASE("a row too many, decimal commas and UTF-16 are read, and the program says what it did") {
  for (const auto& [name, said] : std::vector<std::pair<std::string, std::string>>{
           {"bvh_one_row_more", "in.bvh: ignored: everything after the 5 frames, from '2.666667' on"},
           {"bvh_decimal_commas", "in.bvh: numbers have decimal commas: '0,000000' is read as with a point"},
           {"bvh_utf16", "in.bvh: 2 frames, 30 frames per second"}}) {
    const Case c(name);
    for (const auto& arguments : {std::vector<std::string>{"info", "in.bvh"}, {"convert", "in.bvh", "out.bvh"}}) {
      const auto out = c.run(arguments);
      CHECK(out.code == 0);
      if (name != "bvh_utf16" || arguments.size() == 2) CHECK_MESSAGE(contains(out.text, said), out.text);
    }
    const auto seen = c.run({"doctor", "."});
    if (name != "bvh_utf16") CHECK_MESSAGE(contains(seen.text, said), seen.text);
  }
}

TEST_CASE("another axis up: strip, view and convert say so, doctor finds and mends it, --up turns it") {
  const Case c("bvh_z_up");
  for (const char* made : {"out.svg", "out.html", "out.bvh", "out.npz"}) {
    const auto out = c.run({std::string(made).ends_with("svg")    ? "strip"
                            : std::string(made).ends_with("html") ? "view"
                                                                  : "convert",
                            "in.bvh", made});
    CHECK(out.code == (std::string(made).ends_with("npz") ? 1 : 0));
    CHECK_MESSAGE(contains(out.text, "in.bvh: the figure stands along +Z, not +Y: --up z turns it up"), out.text);
  }
  const auto turned = c.run({"convert", "in.bvh", "turned.npz", "--up", "z"});
  CHECK_MESSAGE((turned.code == 0 && !contains(turned.text, "stands along")), turned.text);
  std::filesystem::create_directories(c / "data");
  std::filesystem::rename(c / "in.bvh", c / "data/in.bvh");
  const auto seen = c.run({"doctor", "data", "--clean", "clean"});
  CHECK_MESSAGE(contains(seen.text, "in.bvh: up axis: the body stands along +Z, not +Y"), seen.text);
  CHECK(c.run({"convert", "clean/in.bvh", "cleaned.npz"}).code == 0);

  auto camera = synthetic::walk({.frames = 40, .fps = 30});
  for (auto& r : camera.root) r = rotate(synthetic::about_x(std::numbers::pi), r - ml::Vec3<double>{0, 1.5, -3});
  for (ml::Index f = 0; f < camera.frames(); ++f)
    camera.rotations(f)[0] = synthetic::about_x(std::numbers::pi) * camera.rotations(f)[0];
  ml::write_bvh(c / "camera.bvh", camera);
  const auto down = c.run({"strip", "camera.bvh", "out.svg"});
  CHECK_MESSAGE(contains(down.text, "camera.bvh: the figure stands along -Y, not +Y: --up y-down turns it up"),
                down.text);
  CHECK(!contains(c.run({"strip", "camera.bvh", "out.svg", "--up", "y-down"}).text, "stands along"));
}

TEST_CASE("names stay as they are, or the line about the file says what became of them") {
  const Case c("bvh_names_lost");
  const auto out = c.run({"convert", "in.bvh", "out.bvh"});
  CHECK_MESSAGE(!contains(out.text, "the name"), out.text);
  const std::string text = ml::read_file(c / "out.bvh");
  for (const char* line : {"ROOT センター", "JOINT 左腕", "JOINT mixamorig:Spine"})
    CHECK_MESSAGE(contains(text, std::string(line) + "\n"), text);
  auto walk = synthetic::walk({.frames = 2});
  walk.skeleton.names[1] = "left hip";
  walk.skeleton.names[5] = "右膝 {1}";
  ml::write_glb(c / "blanks.glb", walk);
  const auto told = c.run({"convert", "blanks.glb", "blanks.bvh"});
  CHECK_MESSAGE(contains(told.text,
                         "blanks.bvh: the names of 2 joints are not as a BVH file can hold: 'left hip' is "
                         "'left_hip' in it"),
                told.text);
}

TEST_CASE("a Git LFS pointer in place of weights, a motion or a timeline is called one") {
  const Workplace w;
  const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 99\n";
  for (const char* file : {"in.bvh", "in.glb", "in.npz", "in.safetensors", "in.txt"}) {
    ml::write_file(w / file, pointer);
    const auto out = w.run({"info", file});
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, std::string(file) + " is not the file but a Git LFS pointer to it (99 bytes)"),
                  out.text);
  }
}
