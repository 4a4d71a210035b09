// Which axis points up: found, turned, and not mistaken for somebody who lies or stands on the hands.
#include <doctest/doctest.h>

#include <motionlang/core/rng.hpp>
#include <motionlang/kinematics/up_axis.hpp>
#include <motionlang/metrics/inspect_motion.hpp>

#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

namespace {

constexpr ml::UpAxis others[] = {ml::UpAxis::z, ml::UpAxis::x, ml::UpAxis::y_down, ml::UpAxis::z_down,
                                 ml::UpAxis::x_down};

/// The motion in a world with that axis up. Its rest pose is turned along, or the root alone is.
ml::Motion seen_with(ml::Motion m, ml::UpAxis axis, bool turn_rest) {
  const auto back = inverse(ml::upright_rotation(axis));
  for (auto& r : m.root) r = rotate(back, r);
  if (turn_rest) {
    for (auto& o : m.skeleton.offsets) o = rotate(back, o);
  }
  for (ml::Index f = 0; f < m.frames(); ++f) {
    const auto pose = m.rotations(f);
    if (turn_rest) {
      for (auto& q : pose) q = back * q * inverse(back);
    } else {
      pose[0] = back * pose[0];
    }
  }
  return m;
}

}  // namespace

TEST_CASE("each axis is turned to +Y by a rotation, Z and -Y about x") {
  for (const ml::UpAxis axis : others) {
    const auto up = rotate(ml::upright_rotation(axis), ml::up_direction(axis));
    CHECK(ml::norm(up - ml::Vec3<double>{0, 1, 0}) < 1e-12);
  }
  for (const ml::UpAxis axis : {ml::UpAxis::z, ml::UpAxis::z_down, ml::UpAxis::y_down}) {
    const auto right = rotate(ml::upright_rotation(axis), ml::Vec3<double>{1, 0, 0});
    CHECK(ml::norm(right - ml::Vec3<double>{1, 0, 0}) < 1e-12);
  }
  CHECK(to_string(ml::UpAxis::y_down) == "-Y");
  CHECK(ml::upright_rotation(ml::UpAxis::found) == ml::Quaternion<double>::identity());
}

TEST_CASE("a walk along any axis is found and turned up; the inspection says the same and mends it") {
  ml::Philox draw{.seed = 2};
  for (int i = 0; i < 40; ++i) {
    auto walk = synthetic::walk({.frames = 40, .fps = 30, .turn = draw.uniform() - 0.5});
    const double heading = 6.28 * draw.uniform();
    for (auto& r : walk.root) r = rotate(synthetic::about_y(heading), r);
    for (ml::Index f = 0; f < walk.frames(); ++f)
      walk.rotations(f)[0] = synthetic::about_y(heading) * walk.rotations(f)[0];
    const ml::UpAxis axis = others[static_cast<std::size_t>(draw.uniform() * 5)];
    const ml::Motion seen = seen_with(walk, axis, draw.uniform() < 0.5);
    CAPTURE(to_string(axis));
    const auto stands = ml::find_up_axis(seen);
    REQUIRE(stands);
    CHECK(stands->axis == axis);
    CHECK(stands->share > 0.9);
    CHECK(synthetic::largest_distance(ml::turned_upright(seen, axis), walk) < 1e-9);
    const ml::Inspection found = ml::inspect_motion(seen);
    REQUIRE(found.has(ml::Fault::up_axis));
    CHECK(synthetic::largest_distance(ml::mended(seen, found.cure), walk) < 0.1);  // feet are put on the floor
    CHECK(!ml::find_up_axis(walk));
    CHECK(!ml::inspect_motion(walk).has(ml::Fault::up_axis));
  }
}

TEST_CASE("the coordinates of a camera: Y down, feet anywhere") {
  auto walk = synthetic::walk({.frames = 40, .fps = 30});
  for (auto& r : walk.root) r = r + ml::Vec3<double>{0.3, -1.4, -4};  // the camera is the origin, at the height of eyes
  const ml::Motion seen = seen_with(walk, ml::UpAxis::y_down, false);
  const auto stands = ml::find_up_axis(seen);
  REQUIRE(stands);
  CHECK(stands->axis == ml::UpAxis::y_down);
  CHECK(ml::inspect_motion(seen).has(ml::Fault::up_axis));
}

TEST_CASE("somebody who lies, or stands on the hands, does not stand along another axis") {
  const auto turned = [](double x, double arms) {
    ml::Motion m{ml::smpl24_skeleton(), 30, {}, {}, ""};
    for (int f = 0; f < 20; ++f) {
      m.root.push_back({0, 1, 0});
      m.local.resize(m.local.size() + 24, ml::Quaternion<double>::identity());
      auto pose = m.rotations(f);
      pose[0] = synthetic::about_x(x);
      for (const char* side : {"left", "right"}) {
        const double sign = side[0] == 'l' ? 1 : -1;
        pose[static_cast<std::size_t>(m.skeleton[std::string(side) + "_shoulder"])] = synthetic::about_z(sign * arms);
      }
    }
    return m;
  };
  CHECK(!ml::find_up_axis(turned(std::numbers::pi / 2, -1.3)));  // on the back
  CHECK(!ml::find_up_axis(turned(std::numbers::pi, 1.4)));       // arms beyond the head
  CHECK(ml::find_up_axis(turned(std::numbers::pi, -1.3)));       // arms at the sides of a body upside down
  ml::Motion unknown = turned(std::numbers::pi, -1.3);
  for (auto& name : unknown.skeleton.names) name = "b" + name;
  CHECK(!ml::find_up_axis(unknown));
}
