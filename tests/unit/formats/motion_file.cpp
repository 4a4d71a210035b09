// Motion files by their extension: every format is read back as it was written, from files and from memory.
#include <doctest/doctest.h>

#include <motionlang/file/file.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

std::vector<std::byte> bytes_of(const std::filesystem::path& path) {
  const auto file = ml::MappedFile::open(path);
  return {file->bytes().begin(), file->bytes().end()};
}
void write_text(const std::filesystem::path& path, std::string_view text) { ml::write_file(path, text); }

constexpr const char* two_roots =
    "HIERARCHY\nROOT A\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    "End Site\n{\nOFFSET 0 10 0\n}\n}\nROOT A\n{\nOFFSET 0 0 0\n"
    "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 10 0\n}\n}\n"
    "MOTION\nFrames: 2\nFrame Time: 0.05\n1 2 3 0 0 0 4 5 6 0 0 0\n1 2 3 0 0 0 4 5 6 0 0 0\n";

}  // namespace

TEST_CASE("a motion is read back from every format that is written") {
  const TemporaryFolder folder;
  const ml::Motion walk = synthetic::walk({.frames = 12, .fps = 20});
  for (const char* name : {"walk.bvh", "walk.glb", "walk.npz", "walk.npy", "UPPER.BVH"}) {
    CAPTURE(name);
    const auto path = folder / name;
    CHECK(ml::is_written_motion(path));
    CHECK(ml::is_motion_file(path));
    ml::write_motion(path, walk);
    const ml::Motion back = ml::read_motion(path);
    CHECK(back.frames() == 12);
    CHECK(back.fps == doctest::Approx(20));
    CHECK(back.name == path.stem().string());
    if (ml::file_kind(path) != ".bvh")  // which goes depth first
      CHECK(synthetic::largest_distance(back, walk) < (ml::file_kind(path) == ".npy" ? 0.03 : 1e-4));

    const auto bytes = bytes_of(path);
    CHECK(ml::motion_bytes(path, walk) == bytes);
    CHECK(ml::motion_bytes(ml::file_kind(path), walk) == bytes);
    const auto parsed = ml::parse_motions(bytes, name);
    REQUIRE(parsed.size() == 1);
    CHECK(parsed.front().root == back.root);
    CHECK(parsed.front().local == back.local);
    CHECK(parsed.front().name == back.name);
  }
}

TEST_CASE("the options of a format are those of its reader and its writer") {
  const TemporaryFolder folder;
  const ml::Motion walk = synthetic::walk({.frames = 4});
  ml::write_motion(folder / "metres.bvh", walk, {.scale = 1});
  ml::write_bvh(folder / "wanted.bvh", walk, {.scale = 1});
  CHECK(bytes_of(folder / "metres.bvh") == bytes_of(folder / "wanted.bvh"));
  CHECK(ml::read_motion(folder / "metres.bvh", {.scale = 1}).root ==
        ml::read_bvh_motion(folder / "metres.bvh", {.scale = 1}).root);

  ml::write_motion(folder / "a.npz", walk, {.body = {.gender = "female", .betas = {1, 2}}});
  const auto sequence = ml::read_amass_sequence(folder / "a.npz");
  CHECK(sequence.gender == "female");
  CHECK(sequence.betas == std::vector<double>{1, 2});

  ml::write_motion(folder / "a.npy", walk);
  CHECK(ml::read_motion(folder / "a.npy", {.rate = 25}).fps == 25);
  ml::write_motion(folder / "a.glb", walk);
  CHECK(ml::read_motion(folder / "a.glb", {.fps = 10}).frames() == 2);
}

TEST_CASE("several motions have different names; one alone is refused where one is wanted") {
  const TemporaryFolder folder;
  write_text(folder / "two.bvh", two_roots);
  const auto motions = ml::read_motions(folder / "two.bvh");
  REQUIRE(motions.size() == 2);
  CHECK(motions[0].name == "A");
  CHECK(motions[1].name == "A_2");
  CHECK(motions[1].root_at(0).x == doctest::Approx(0.04));
  CHECK_ERROR(ml::read_motion(folder / "two.bvh"), "[motionlang.config.102]");

  std::set<std::string> taken;
  for (const char* wanted : {"walk", "walk_2", "walk_3", "walk_4", "walk_5"})
    CHECK(ml::unique_name("walk", taken) == wanted);
  CHECK(ml::unique_name("run", taken) == "run");
}

TEST_CASE("what is left out is noted") {
  const TemporaryFolder folder;
  const std::string text =
      "HIERARCHY\nROOT A\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
      "JOINT bone\n{\nOFFSET 0 1 0\nCHANNELS 3 Xposition Yposition Zposition\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n"
      "JOINT other\n{\nOFFSET 1 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n}\n"
      "MOTION\nFrames: 2\nFrame Time: 0.05\n1 2 3 0 0 0 0 1 0 0 0 0\n1 2 3 0 0 0 0 9 0 0 0 0\n";
  write_text(folder / "stretched.bvh", text);
  std::string notes;
  ml::read_motions(folder / "stretched.bvh", {}, &notes);
  CHECK(notes == (folder / "stretched.bvh").string() +
                     ": left out: how 'bone' moves away from the joint before: bones keep their mean length\n");

  ml::Motion posed = synthetic::walk({.frames = 40});
  for (auto& q : posed.rotations(0)) q = ml::Quaternion<double>::identity();
  ml::write_motion(folder / "posed.glb", posed);
  const ml::Index frames = ml::detect_t_pose_lead_in(posed);
  REQUIRE(frames == 1);
  notes.clear();
  CHECK(ml::read_motion(folder / "posed.glb", {.drop_lead_in = true}, &notes).frames() == 39);
  CHECK(notes == (folder / "posed.glb").string() + ": left out: 1 frame of an inserted T-pose at the start\n");
  CHECK(ml::read_motion(folder / "posed.glb").frames() == 40);
}

TEST_CASE("the skeleton of an AMC file is found beside it") {
  const TemporaryFolder folder;
  CHECK(ml::asf_beside(folder / "01_02.amc").string() == (folder / "01.asf").string());
  write_text(folder / "01_02.amc", ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1 0 0 0 0\n2\nroot 0 1 0 0 0 0\n");
  CHECK_ERROR(ml::read_motions(folder / "01_02.amc"), "there is no skeleton ");
  CHECK_ERROR(ml::read_motions(folder / "01_02.amc"), "[motionlang.io.401]");
  write_text(folder / "other.asf",
             ":version 1.10\n:name n\n:units\nmass 1.0\nlength 0.45\nangle deg\n:root\naxis XYZ\n"
             "order TX TY TZ RZ RY RX\nposition 0 0 0\norientation 0 0 0\n:bonedata\nbegin\nid 1\n"
             "name thigh\ndirection 1 0 0\nlength 2\naxis 0 0 0 XYZ\nend\n:hierarchy\nbegin\nroot thigh\nend\n");
  CHECK(ml::asf_beside(folder / "01_02.amc").string() == (folder / "other.asf").string());
  CHECK(ml::read_motion(folder / "01_02.amc").fps == 120);
  CHECK(ml::read_motion(folder / "01_02.amc", {.rate = 60}).fps == 60);
  std::filesystem::rename(folder / "other.asf", folder / "far.txt");
  CHECK(ml::read_motion(folder / "01_02.amc", {.asf = (folder / "far.txt").string()}).frames() == 2);
}

TEST_CASE("other kinds of files are refused with those that are known") {
  const ml::Motion walk = synthetic::walk({.frames = 2});
  CHECK_ERROR(ml::read_motions("/nowhere/walk.fbx"), "[motionlang.config.103]");
  CHECK_ERROR(ml::read_motions("/nowhere/walk.fbx"), "Blender makes");
  CHECK_ERROR(ml::read_motions("/nowhere/walk.bvh"), "[motionlang.io.401]");
  CHECK_ERROR(ml::write_motion("/nowhere/walk.html", walk), "[motionlang.config.103]");
  CHECK_ERROR(ml::write_motion("/nowhere/walk.bvh", walk), "[motionlang.io.401]");
  CHECK_ERROR(ml::motion_bytes(".fbx", walk), "[motionlang.config.103]");
  CHECK_ERROR(ml::parse_motions({}, "walk.txt"), "[motionlang.config.103]");
  CHECK(ml::is_gltf("a.vrm"));
  CHECK_FALSE(ml::is_motion_file("a.vrm"));
  CHECK_FALSE(ml::is_motion_file("a.json"));
  CHECK_FALSE(ml::is_written_motion("a.amc"));
}
