// Clips from positions of joints: the positions come back, whatever the figure does.
#include <motionlang/core/rng.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/motion_from_joints.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index, ml::Vec3;

namespace {

double largest_distance(const std::vector<Vec3<double>>& a, const std::vector<Vec3<double>>& b) {
  REQUIRE(a.size() == b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, norm(a[i] - b[i]));
  return largest;
}
/// Turns and bends of every joint, more than people can.
ml::Motion acrobat(const ml::Skeleton& skeleton, Index frames) {
  ml::Motion m{skeleton, 20, {}, {}, "acrobat"};
  ml::Philox rng{.seed = 3};
  for (Index f = 0; f < frames; ++f) {
    m.root.push_back({0.01 * static_cast<double>(f), 0.9, 0});
    for (int j = 0; j < skeleton.size(); ++j) {
      std::array<double, 3> v{};
      rng.normal(std::span<double>(v));
      const double size = j == 0 ? 1.5 : 0.5;
      m.local.push_back(to_quaternion(ml::AxisAngle<double>{Vec3<double>{size * v[0], size * v[1], size * v[2]}}));
    }
  }
  return m;
}

}  // namespace

TEST_CASE("positions along bones of constant length are met") {
  for (const ml::Skeleton* s : {&ml::smpl24_skeleton(), &ml::humanml3d22_skeleton(), &ml::kit21_skeleton()}) {
    const ml::Motion m = acrobat(*s, 60);
    const auto joints = m.positions();
    const ml::Motion again = ml::motion_from_joints(*s, joints, 20);
    CHECK(largest_distance(again.positions(), joints) < 2e-5);
  }
}

TEST_CASE("another size of the figure, and fewer joints than the skeleton has") {
  ml::Skeleton child = ml::humanml3d22_skeleton();
  for (auto& o : child.offsets) o = 0.6 * o;
  const ml::Motion m = acrobat(child, 20);
  const auto joints = m.positions();
  const ml::Motion again = ml::motion_from_joints(ml::smpl24_skeleton(), joints, 22, 25);
  CHECK(again.skeleton.size() == 24);
  CHECK(again.fps == 25);
  CHECK(norm(again.skeleton.offsets[4]) == doctest::Approx(0.6 * norm(ml::smpl24_skeleton().offsets[4])));
  const auto positions = again.positions();
  double largest = 0;
  for (std::size_t i = 0; i < joints.size(); ++i)
    largest = std::max(largest, norm(positions[i / 22 * 24 + i % 22] - joints[i]));
  CHECK(largest < 2e-5);
}

TEST_CASE("no twist where positions say nothing of it, and the root faces what it faces") {
  ml::Motion m = acrobat(ml::smpl24_skeleton(), 0);
  for (int k = 0; k < 8; ++k) {
    m.root.push_back({0, 1, 0});
    m.local.resize(m.root.size() * 24, ml::Quaternion<double>::identity());
    m.local[m.local.size() - 24] = ml::from_axis_angle(Vec3<double>{0, 1, 0}, k * std::numbers::pi / 4);
  }
  const ml::Motion again = ml::motion_from_joints(m.skeleton, m.positions(), 20);
  for (std::size_t i = 0; i < m.local.size(); ++i)
    CHECK(std::abs(dot(m.local[i], again.local[i])) == doctest::Approx(1).epsilon(1e-9));
}

TEST_CASE("errors, and clips of no frames") {
  const auto& s = ml::humanml3d22_skeleton();
  CHECK(ml::motion_from_joints(s, {}, 20).frames() == 0);
  std::vector<Vec3<double>> joints(23);
  CHECK_ERROR(ml::motion_from_joints(s, joints, 20), "[motionlang.shape.205]");
  CHECK_ERROR(ml::motion_from_joints(s, joints, 23, 20), "[motionlang.config.101]");
  joints.resize(22);
  CHECK(ml::motion_from_joints(s, joints, 20).frames() == 1);  // all in one point
  joints[5].x = std::nan("");
  CHECK_ERROR(ml::motion_from_joints(s, joints, 20), "[motionlang.numeric.301]");
}

TEST_CASE("another build of the figure: bones at a joint lie to one another as they do in the clip") {
  ml::Skeleton broad = ml::humanml3d22_skeleton();
  broad.offsets[static_cast<std::size_t>(broad["left_hip"])] = {0.06, -0.11, -0.02};
  broad.offsets[static_cast<std::size_t>(broad["right_hip"])] = {-0.06, -0.11, -0.02};
  broad.offsets[static_cast<std::size_t>(broad["left_collar"])] = {0.13, 0.05, -0.04};
  broad.offsets[static_cast<std::size_t>(broad["right_collar"])] = {-0.12, 0.06, -0.04};
  const ml::Motion m = acrobat(broad, 60);
  const auto joints = m.positions();
  const ml::Motion again = ml::motion_from_joints(ml::humanml3d22_skeleton(), joints, 20);
  CHECK(largest_distance(again.positions(), joints) < 2e-3);
}
