// Walks on the spot, which go ahead as fast as their feet slide, and motions that stay as they are.
#include <motionlang/kinematics/treadmill.hpp>

#include <doctest/doctest.h>

#include <motionlang/kinematics/motion_tools.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

namespace {

ml::Motion on_the_spot(ml::Motion m) {
  for (auto& root : m.root) root.x = root.z = 0;
  return m;
}
ml::Vec3<double> way(const ml::Motion& m) { return m.root.back() - m.root.front(); }

}  // namespace

TEST_CASE("a walk on the spot goes as far as the walk that it was, slow or fast, ahead or to the side") {
  for (const double steps : {1.2, 2.4}) {
    const auto walk = synthetic::walk({.frames = 80, .steps_per_second = steps});
    const auto found = ml::off_treadmill(on_the_spot(walk));
    CHECK(way(walk).z > 1);
    CHECK(way(found).z == doctest::Approx(way(walk).z).epsilon(0.15));
    CHECK(std::abs(way(found).x) < 0.1);
    CHECK(ml::floor_speed(on_the_spot(walk)).z < -0.25);
    CHECK(std::abs(ml::floor_speed(walk).z) < 0.05);
  }
  auto aside = on_the_spot(synthetic::walk({.frames = 80}));
  const double ahead = way(ml::off_treadmill(aside)).z;
  for (ml::Index f = 0; f < aside.frames(); ++f)
    aside.rotations(f)[0] = synthetic::about_y(1.5708) * aside.rotations(f)[0];
  CHECK(way(ml::off_treadmill(aside)).x == doctest::Approx(ahead).epsilon(0.01));
}

TEST_CASE("who walks already, stands, or is in the air stays as he is") {
  const auto walk = synthetic::walk({.frames = 80});
  auto flying = on_the_spot(walk);
  for (auto& root : flying.root) root.y += 1;
  for (const ml::Motion& m : {walk, synthetic::jump(), ml::crop(walk, 3, 4), flying, ml::crop(walk, 0, 0)})
    CHECK(synthetic::largest_distance(ml::off_treadmill(m), m) < 1e-12);
  auto other = ml::crop(walk, 0, 2);
  other.skeleton = ml::Skeleton{};
  CHECK_ERROR(ml::off_treadmill(other), "[motionlang.config.103] floor_speed: ");
}
