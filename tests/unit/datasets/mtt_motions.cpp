// The recorded motions of MTT's texts: parts of files, as they are or in a mirror.
#include <motionlang/datasets/mtt_motions.hpp>

#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/motion_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using Joints = std::vector<ml::Vec3<double>>;

namespace {

double farthest(const Joints& a, const Joints& b) {
  REQUIRE(a.size() == b.size());
  double out = 0;
  for (std::size_t i = 0; i < a.size(); ++i) out = std::max(out, norm(a[i] - b[i]));
  return out;
}
void write_joints(const std::filesystem::path& file, const Joints& joints, ml::Index per_frame) {
  std::vector<float> values;
  for (const auto& p : joints)
    for (const double x : {p.x, p.y, p.z}) values.push_back(static_cast<float>(x));
  const ml::Index frames = std::ssize(joints) / per_frame;
  ml::write_npy(file, ml::NpyArray::of(std::span<const float>(values), {frames, per_frame, 3}));
}
Joints part(const Joints& all, ml::Index first, ml::Index end) {
  return {all.begin() + 22 * first, all.begin() + 22 * end};
}

}  // namespace

TEST_CASE("parse_mtt_motions: a path and two times on each line") {
  const auto clips = ml::parse_mtt_motions("KIT/3/kick # 0.5 # 2\n\nM/CMU/01/01_02 # 0 # 1.25\r\n");
  CHECK(clips == std::vector<ml::MttClip>{{"KIT/3/kick", 0.5, 2}, {"M/CMU/01/01_02", 0, 1.25}});
  CHECK_ERROR(ml::parse_mtt_motions("walk # 1\n", "list"), "[motionlang.timeline.501] list:1:9");
  CHECK_ERROR(ml::parse_mtt_motions("walk # 1 # x\n"), "[motionlang.timeline.502]");
  CHECK_ERROR(ml::parse_mtt_motions("walk # 1 # 1.04\n"), "[motionlang.timeline.504]");
  CHECK_ERROR(ml::parse_mtt_motions("\n"), "[motionlang.timeline.507]");
}

TEST_CASE("read_mtt_motion: joints as they are, Z up or Y up, with or without hands") {
  const TemporaryFolder folder;
  const ml::Motion walk = synthetic::walk({.frames = 50, .turn = 0.5});
  const Joints body = ml::detail::first_joints(walk, 22), wanted = part(body, 10, 40);
  std::filesystem::create_directory(folder / "KIT");
  write_joints(folder / "KIT/walk.npy", ml::detail::turned_up(walk.positions(), true), 24);  // Z up, as AMASS
  write_joints(folder / "y_up.npy", body, 22);
  CHECK(farthest(ml::read_mtt_motion(ml::FilePath(folder.path), {"KIT/walk", 0.5, 2}), wanted) < 1e-6);
  CHECK(farthest(ml::read_mtt_motion(ml::FilePath(folder.path), {"y_up.npy", 0.5, 2}), wanted) < 1e-6);
  // A clip that ends behind the file ends with it.
  CHECK(farthest(ml::read_mtt_motion(ml::FilePath(folder.path), {"y_up", 2, 9}), part(body, 40, 50)) < 1e-6);
  CHECK_ERROR(ml::read_mtt_motion(ml::FilePath(folder.path), {"y_up", 2.45, 9}), "[motionlang.shape.203]");
  CHECK_ERROR(ml::read_mtt_motion(ml::FilePath(folder.path), {"jump", 0, 1}), ": there is no motion jump");
}

TEST_CASE("read_mtt_motion: any motion file, at 20 frames per second; M/ is a mirror unless it has a file") {
  const TemporaryFolder folder;
  const ml::Motion walk = synthetic::walk({.frames = 90, .fps = 30, .turn = 0.7});
  ml::write_motion(folder / "walk.bvh", walk);
  const Joints once = ml::read_mtt_motion(ml::FilePath(folder.path), {"walk", 0, 2});
  REQUIRE(once.size() == 22 * 40);
  const Joints all = ml::detail::first_joints(walk, 22);
  CHECK(norm(once[22 * 20] - all[22 * 30]) < 1e-3);  // the root after a second
  const Joints mirrored = ml::read_mtt_motion(ml::FilePath(folder.path), {"M/walk", 0, 2});
  for (std::size_t f = 0; f < 40; ++f) {  // the left foot is where the right one is in the mirror
    const auto left = once[22 * f + 10], right = mirrored[22 * f + 11];
    CHECK(norm(right - ml::Vec3<double>{-left.x, left.y, left.z}) < 1e-9);
  }
  std::filesystem::create_directory(folder / "M");
  ml::write_motion(folder / "M/walk.bvh", walk);
  CHECK(farthest(ml::read_mtt_motion(ml::FilePath(folder.path), {"M/walk", 0, 2}), once) < 1e-9);
}
