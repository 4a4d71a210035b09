// Files and folders of motion to other files.
#include <doctest/doctest.h>

#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/kinematics/mirror_joints.hpp>
#include <motionlang/view/convert_motions.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

}  // namespace

TEST_CASE("a file becomes another, edited on the way, with a line about it") {
  const TemporaryFolder w;
  ml::write_bvh(w / "walk.bvh", synthetic::walk({.frames = 60, .fps = 20}));
  ml::ConversionNotes notes;
  ml::convert_motions(w / "walk.bvh", w / "part.bvh", {.time = {.from = 1, .to = 2}}, &notes);
  CHECK(ml::read_bvh_motion(w / "part.bvh").frames() == 20);
  CHECK(notes.results == (w / "part.bvh").string() + ": 20 frames at 20 per second, 1.00 s, 24 joints\n");
  CHECK(notes.input.empty());
  CHECK_THROWS_AS(ml::convert_motions(w / "walk.bvh", w / "x.bvh", {.time = {.from = 50}}), ml::option_error);

  notes = {};
  ml::convert_motions(w / "walk.bvh", w / "rows.npy", {.features = "guoh3d"}, &notes);
  CHECK(ml::read_npy(w / "rows.npy").shape == std::vector<ml::Index>{59, 263});
  CHECK(contains(notes.results, "rows.npy: 59 rows of 263 numbers at 20 per second, 2.95 s\n"));
  CHECK_THROWS_AS(ml::convert_motions(w / "walk.bvh", w / "rows.bvh", {.features = "guoh3d"}), ml::option_error);

  notes = {};
  ml::convert_motions(w / "walk.bvh", w / "walk.vrma", {}, &notes);
  CHECK(contains(notes.results, "walk.vrma: 22 bones; VRM has none for 'left_hand' and 1 other joint\n"));
  notes = {};
  ml::convert_motions(w / "walk.vrma", w / "again.vrma", {}, &notes);
  CHECK(!contains(notes.results, "VRM has none"));

  const auto still = [](const ml::Motion& m) { return ml::motion_features("guoh3d").skeleton() == m.skeleton ? m : m; };
  ml::convert_motions(w / "walk.bvh", w / "same.bvh", {.denoise = still});
  CHECK(ml::read_file(w / "same.bvh") == ml::read_file(w / "walk.bvh"));
  CHECK_THROWS_AS(ml::convert_motions(w / "walk.bvh", w / "walk.bvh", {.inputs = {w / "walk.bvh"}}), ml::option_error);
  CHECK_ERROR(ml::convert_motions(w / "walk.bvh", w / "walk.fbx", {}), "[motionlang.config.103]");
}

TEST_CASE("several motions of a file go into one where the format holds them, else each into its own") {
  const TemporaryFolder w;
  auto first = synthetic::walk({.frames = 20}), second = synthetic::walk({.frames = 30});
  first.name = "go", second.name = "go/on";
  const std::vector<ml::Motion> two{first, second};
  ml::write_glb(w / "two.glb", two);
  ml::ConversionNotes notes;
  ml::convert_motions(w / "two.glb", w / "both.glb", {}, &notes);
  CHECK(contains(notes.results, "both.glb: 2 motions, 24 joints\n"));
  ml::convert_motions(w / "two.glb", w / "one.bvh", {});
  CHECK(ml::read_bvh_motion(w / "one_go.bvh").frames() == 20);
  CHECK(ml::read_bvh_motion(w / "one_go_on.bvh").frames() == 30);
  // One that fails stops no other, and is reported in the end.
  CHECK_ERROR(ml::convert_motions(w / "two.glb", w / "short.bvh", {.time = {.from = 1.2}}), "1 of the 2 motions of");
  CHECK(fs::exists(w / "short_go_on.bvh"));
}

TEST_CASE("what an AMASS file has and the result lacks is a note") {
  const TemporaryFolder w;
  ml::write_amass(w / "walk.npz", synthetic::walk({.frames = 20}), {.gender = "female", .betas = {0.5, 1}});
  ml::ConversionNotes notes;
  ml::convert_motions(w / "walk.npz", w / "walk.bvh", {}, &notes);
  CHECK(contains(notes.input, "walk.npz: left out: betas; `body` shows them\n"));
  notes = {};
  ml::convert_motions(w / "walk.npz", w / "again.npz", {}, &notes);
  CHECK(notes.input.empty());
  const auto again = ml::read_amass(w / "again.npz");
  CHECK(again.body.gender == "female");
  CHECK(again.body.betas.at(1) == 1);
}

TEST_CASE("a folder keeps its shape; files that fail are listed") {
  const TemporaryFolder w;
  fs::create_directories(w / "in/deep");
  const auto walk = synthetic::walk({.frames = 20});
  ml::write_bvh(w / "in/a.bvh", walk, {.scale = 1e4});
  ml::write_bvh(w / "in/deep/b.bvh", walk, {.scale = 1e4});
  ml::write_file(w / "in/broken.bvh", std::string_view("HIERARCHY\n"));
  ml::FolderConversion done;
  ml::convert_folder(w / "in", w / "out", ".glb", {}, done);
  CHECK(done.files == 3);
  CHECK(done.done == 3);
  CHECK(done.converted == 2);
  REQUIRE(done.failures.size() == 1);
  CHECK_MESSAGE(contains(done.failures[0], "broken.bvh: [motionlang.io.40"), done.failures[0]);
  REQUIRE(done.notes.size() == 1);  // one note of two files
  CHECK(contains(done.notes.begin()->second.first, "a.bvh: the figure is "));
  CHECK(done.notes.begin()->second.second == 1);
  CHECK(fs::exists(w / "out/a.glb"));
  CHECK(fs::exists(w / "out/deep/b.glb"));

  ml::FolderConversion beside;
  ml::convert_folder(w / "in/deep", "", ".svg", {}, beside);
  CHECK(fs::exists(w / "in/deep/b.bvh.svg"));
  ml::FolderConversion set;
  ml::convert_folder(w / "in/deep", w / "set", "", {.data_set = ml::find_data_set_form("guoh3d")}, set);
  CHECK_MESSAGE(set.failures.empty(), set.failures.front());
  CHECK(fs::exists(w / "set/new_joint_vecs/b.npy"));
  CHECK(contains(ml::read_file(w / "set/all.txt"), "b"));

  ml::FolderConversion none;
  CHECK_THROWS_AS(ml::convert_folder(w / "in", w / "in/deep/..", ".bvh", {}, none), ml::option_error);
  fs::create_directories(w / "empty");
  CHECK_ERROR(ml::convert_folder(w / "empty", w / "out", ".bvh", {}, none), "[motionlang.config.101]");
  const auto stop = [](ml::Index, ml::Index) { return false; };
  ml::FolderConversion stopped;
  CHECK_THROWS_AS(ml::convert_folder(w / "in", w / "out2", ".bvh", {}, stopped, stop), ml::cancelled);
  CHECK(stopped.done == 1);
}
