// A path that is bent: its angle, its length, and feet that stay where they stand.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include <motionlang/kinematics/curved_path.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/loops.hpp>

namespace ml = motionlang;

namespace {

/// A body that glides 2 m ahead in 40 frames, with both feet 30 cm up.
ml::Motion glide() {
  ml::Motion m;
  m.skeleton = ml::smpl24_skeleton();
  m.fps = 20;
  for (int f = 0; f <= 40; ++f) {
    m.root.push_back({0, 1.25, 0.05 * f});
    m.local.insert(m.local.end(), static_cast<std::size_t>(m.skeleton.size()), ml::Quaternion<double>::identity());
  }
  return m;
}

}  // namespace

TEST_CASE("a straight path becomes an arc of a circle that is as long and turns to the side of the curvature") {
  const ml::Motion straight = glide();
  CHECK(ml::path_length(straight) == doctest::Approx(2));
  for (const double curvature : {std::numbers::pi / 2, -std::numbers::pi / 2}) {  // a radius of 2 / pi
    const ml::Motion bent = ml::curved_path(straight, curvature);
    CHECK(ml::path_length(bent) == doctest::Approx(2));
    CHECK(std::abs(ml::detail::heading(bent.rotations(40)[0])) == doctest::Approx(std::numbers::pi));
    CHECK(std::abs(bent.root_at(40).z) < 0.051);  // half a circle ends beside its start, up to one step
    CHECK(bent.root_at(40).x == doctest::Approx(std::copysign(4 / std::numbers::pi, curvature)).epsilon(0.01));
    CHECK(bent.root_at(40).y == straight.root_at(40).y);
  }
  const ml::Motion same = ml::curved_path(straight, 0);
  CHECK(same.root_at(40).z == doctest::Approx(2));
}
