// The motion files of a folder: which are found, which are left out, and what is said about them.
#include <doctest/doctest.h>

#include <motionlang/file/npy.hpp>
#include <motionlang/formats/motion_folder.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

TEST_CASE("motion files below a folder are found in order, without statistics and second forms") {
  const TemporaryFolder folder;
  const ml::Motion walk = synthetic::walk({.frames = 3});
  for (const char* name : {"b", "data/new_joints", "data/new_joint_vecs", "out"}) fs::create_directories(folder / name);
  for (const char* name : {"b/2.bvh", "a.glb", "data/new_joints/1.npy", "data/new_joint_vecs/1.npy", "out/a.bvh"})
    ml::write_motion(folder / name, walk);
  ml::write_file(folder / "notes.txt", std::string_view("no motion"));
  ml::write_file(folder / "avatar.vrm", std::string_view("no motion"));
  const std::vector<float> mean(3);
  ml::write_npy(folder / "mean.npy", ml::NpyArray::of(std::span<const float>(mean), {3}));
  CHECK_FALSE(ml::may_hold_frames(folder / "mean.npy"));
  CHECK(ml::may_hold_frames(folder / "data/new_joints/1.npy"));
  CHECK(ml::may_hold_frames(folder / "missing.npy"));  // its reader says why

  std::string notes;
  const auto files = ml::motion_files_below(folder.path, folder / "out", &notes);
  CHECK(files == std::vector<fs::path>{folder / "a.glb", folder / "b/2.bvh", folder / "data/new_joint_vecs/1.npy"});
  CHECK(notes == "not read: " + (folder / "out").string() + ", where results go\n");
  CHECK(ml::motion_files_below(folder.path).size() == 4);
  CHECK_ERROR(ml::motion_files_below(folder / "nothing"), "[motionlang.io.401]");
}

TEST_CASE("links that lead nowhere are noted, links to folders are not followed") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "clips");
  std::error_code none;
  fs::create_directory_symlink("..", folder / "clips/around", none);
  fs::create_symlink("a.bvh", folder / "clips/a.bvh", none);  // itself
  if (none) return;                                           // a system without links
  std::string notes;
  CHECK(ml::motion_files_below(folder.path, "", &notes).empty());
  CHECK(notes.starts_with("skipped: " + (folder / "clips/a.bvh").string() + ": "));
}

TEST_CASE("of many files, one that says what an option says is read as it is") {
  const TemporaryFolder folder;
  ml::write_motion(folder / "a.npz", synthetic::walk({.frames = 3, .fps = 30}));
  const ml::MotionReadOptions options{.rate = 60, .asf = "one.asf"};
  CHECK(ml::options_for_file(options, folder / "a.npz").rate == 0);
  CHECK(ml::options_for_file(options, folder / "a.npy").rate == 60);
  CHECK(ml::options_for_file(options, folder / "01_01.amc").asf == "one.asf");
  ml::write_file(folder / "01.asf", std::string_view(""));
  CHECK(ml::options_for_file(options, folder / "01_01.amc").asf.empty());
  CHECK(ml::is_same_place(folder.path, folder / "."));
  CHECK_FALSE(ml::is_same_place(folder.path, folder / "a.npz"));
}
