// The published clip 012314 of HumanML3D: joints to features and back. The data are not part of the repository: the
// test runs where the environment variable MOTIONLANG_DATA names a folder with humanml3d/new_joints_012314.npy and
// humanml3d/new_joint_vecs_012314.npy.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>

#include <motionlang/features/guoh3d.hpp>
#include <motionlang/features/guoh3d_extraction.hpp>
#include <motionlang/file/npy.hpp>

#include "../../support/lists.hpp"

namespace ml = motionlang;
using lists::view;

namespace {

std::vector<ml::Vec3<double>> vectors(const std::vector<double>& values) {
  std::vector<ml::Vec3<double>> out;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) out.push_back({values[i], values[i + 1], values[i + 2]});
  return out;
}

}  // namespace

TEST_CASE("guoh3d: the published clip") {
  const char* folder = std::getenv("MOTIONLANG_DATA");
  const auto clip = std::filesystem::path(folder ? folder : "") / "humanml3d";
  if (folder == nullptr || !std::filesystem::exists(clip / "new_joint_vecs_012314.npy")) {
    MESSAGE("skipped: MOTIONLANG_DATA names no folder with humanml3d/new_joint_vecs_012314.npy");
    return;
  }
  const auto want = ml::read_npy(clip / "new_joint_vecs_012314.npy").to<double>();
  const auto published_joints = vectors(ml::read_npy(clip / "new_joints_012314.npy").to<double>());
  REQUIRE(want.size() == 170 * 263);
  REQUIRE(published_joints.size() == 170 * 22);

  const auto back = ml::guoh3d_joints(view(want));
  REQUIRE(back.size() == published_joints.size());
  double worst = 0;
  for (std::size_t i = 0; i < back.size(); ++i) worst = std::max(worst, ml::norm(back[i] - published_joints[i]));
  MESSAGE("features to joints: largest distance ", worst);
  CHECK(worst < 1e-5);

  auto compare = [&](const std::vector<ml::Vec3<double>>& joints, std::size_t rows) {
    const auto got = ml::guoh3d_features(ml::humanml3d_chains(), view(joints));
    REQUIRE(got.size() >= rows * 263);
    double largest = 0;
    for (std::size_t i = 0; i < rows * 263; ++i) largest = std::max(largest, std::abs(got[i] - want[i]));
    return largest;
  };
  // A row is made of two frames, so the published features of 170 rows came from 171 frames, of which 170 positions are
  // published. Smoothing carries the missing one back over 80 frames.
  const double first = compare(published_joints, 170 - 81);
  MESSAGE("joints to features, first 89 rows: largest difference ", first);
  CHECK(first < 1e-4);
  // The last row's velocities tell the missing frame.
  auto joints = published_joints;
  const auto all = ml::guoh3d_joints(view(want), 22, {.last_frame = true});
  joints.insert(joints.end(), all.end() - 22, all.end());
  const double whole = compare(joints, 170);
  MESSAGE("joints to features, all rows: largest difference ", whole);
  CHECK(whole < 1e-4);
}
