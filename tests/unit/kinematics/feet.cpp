// Feet: when they stand, the leg that reaches for a place, and clips whose feet are made to stay there.
#include <algorithm>

#include <doctest/doctest.h>

#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/limb_ik.hpp>
#include <motionlang/kinematics/retarget.hpp>
#include <motionlang/metrics/motion_quality.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using doctest::Approx, doctest::Contains;

namespace {

ml::Vec3<double> place(const ml::Motion& m, ml::Index frame, int joint) {
  ml::JointTransforms<double> world;
  m.world(frame, world);
  return world.position[static_cast<std::size_t>(joint)];
}

/// The clip with its root drifting `speed` m/s along x.
ml::Motion drifting(ml::Motion m, double speed) {
  for (ml::Index f = 0; f < m.frames(); ++f)
    m.root[static_cast<std::size_t>(f)].x += speed * static_cast<double>(f) / m.fps;
  return m;
}

double skate(const ml::Motion& m) { return ml::motion_quality(m).feet.speed; }

}  // namespace

TEST_CASE("a leg reaches for a place, keeps its bones and the way its foot points") {
  const auto walk = synthetic::walk({.frames = 12});
  const ml::Limb leg = ml::smpl_legs[0].limb;
  for (ml::Index f = 0; f < walk.frames(); ++f) {
    auto moved = walk;
    ml::JointTransforms<double> before, after;
    walk.world(f, before);
    const ml::Vec3<double> target = before.position[7] + ml::Vec3<double>{0.05, 0.04, -0.03};
    ml::reach(moved.skeleton, moved.rotations(f), before, leg, target, {0, 0, 1});
    moved.world(f, after);
    CHECK(ml::norm(after.position[7] - target) < 1e-9);
    CHECK(ml::distance(after.rotation[7], before.rotation[7]) < 1e-6);
    CHECK(ml::norm(after.position[10] - after.position[7] - (before.position[10] - before.position[7])) < 1e-9);
    CHECK(ml::norm(after.position[8] - before.position[8]) == 0);  // the other leg
  }
}

TEST_CASE("a leg that cannot reach a place points at it") {
  auto moved = synthetic::walk({.frames = 1});
  ml::JointTransforms<double> before, after;
  moved.world(0, before);
  const auto hip = before.position[1];
  const ml::Vec3<double> target = hip + ml::Vec3<double>{1.0, -2.0, 0.5};
  ml::reach(moved.skeleton, moved.rotations(0), before, ml::smpl_legs[0].limb, target, {0, 0, 1});
  moved.world(0, after);
  const double length = ml::norm(after.position[7] - after.position[4]) + ml::norm(after.position[4] - hip);
  CHECK(ml::norm(after.position[7] - hip) == Approx(length).epsilon(1e-3));
  CHECK(ml::norm(ml::normalized(after.position[7] - hip) - ml::normalized(target - hip)) < 1e-6);
}

TEST_CASE("a straight leg bends in the given direction; three joints that are not a limb are refused") {
  ml::Motion rest{ml::smpl24_skeleton(), 20, {{0, 0.95, 0}}, std::vector(24, ml::Quaternion<double>::identity()), {}};
  ml::JointTransforms<double> before, after;
  rest.world(0, before);
  const auto target = before.position[7] + ml::Vec3<double>{0, 0.1, 0};
  ml::reach(rest.skeleton, rest.rotations(0), before, ml::smpl_legs[0].limb, target, {0, 0, 1});
  rest.world(0, after);
  CHECK(ml::norm(after.position[7] - target) < 1e-9);
  CHECK(after.position[4].z > before.position[4].z + 0.05);  // knees bend forward
  CHECK(after.position[4].x == Approx(before.position[4].x));
  CHECK_THROWS_WITH_AS(ml::reach(rest.skeleton, rest.rotations(0), before, {1, 5, 7}, target, {0, 0, 1}),
                       Contains("[motionlang.config.103] reach: joints 1, 5, 7 are not a limb"), ml::config_error);
  for (const ml::Limb& wrong : {ml::Limb{-1, 0, 3}, {0, -1, 0}, {1, 4, 24}, {4, 7, -1}})
    CHECK_ERROR(ml::reach(rest.skeleton, rest.rotations(0), before, wrong, target, {0, 0, 1}),
                "are not a limb of a skeleton of 24");
  CHECK_ERROR(ml::reach(rest.skeleton, rest.rotations(0).first(20), before, {1, 4, 7}, target, {0, 0, 1}),
              "[motionlang.shape.205] reach: 20 rotations for 24 joints");
  before.position[7] = before.position[4];
  CHECK_ERROR(ml::reach(rest.skeleton, rest.rotations(0), before, {1, 4, 7}, target, {0, 0, 1}),
              "[motionlang.numeric.302] reach: bones of ");
}

TEST_CASE("feet of a skeleton that has no such legs are refused, whatever the clip") {
  const ml::Motion kit{ml::kit21_skeleton(), 20, {}, {}, {}};
  CHECK_ERROR(ml::path_from_feet(kit), "[motionlang.config.103] path_from_feet: joints 1, 4, 7 are not a limb");
  CHECK_ERROR(ml::lock_feet(kit),
              "[motionlang.config.103] lock_feet: joints 1, 4, 7 are not a limb of a skeleton of 21");
  const ml::Leg without_toe[] = {{{1, 4, 7}, 24}};
  CHECK_ERROR(ml::fix_feet(synthetic::walk({.frames = 1}), without_toe),
              "[motionlang.config.103] turn_from_feet: toe 24 of a skeleton of 24");
}

TEST_CASE("between contacts that are near each other the leg is corrected no more than in them") {
  // It stands and drifts ahead, is carried 10 cm within two steps, and drifts back: both contacts pull the same way.
  auto clip = synthetic::walk({.frames = 1});
  const auto start = clip.root[0];
  const std::vector<double> x{0, 1, 2, 3, 4, 9, 14, 13, 12, 11, 10};  // cm
  clip.root.clear();
  const auto pose = clip.local;
  clip.local.clear();
  for (const double cm : x) {
    clip.root.push_back(start + ml::Vec3{0.01 * cm, 0.0, 0.0});
    clip.local.insert(clip.local.end(), pose.begin(), pose.end());
  }
  const auto fixed = ml::lock_feet(clip);
  auto pulled = [&](ml::Index f) { return place(fixed, f, 8).x - place(clip, f, 8).x; };
  CHECK(pulled(4) == Approx(-0.02).epsilon(1e-3));
  CHECK(pulled(6) == Approx(-0.02).epsilon(1e-3));
  CHECK(pulled(5) == Approx(-0.02).epsilon(1e-3));
}

TEST_CASE("contacts: low and slow") {
  const auto walk = synthetic::walk({.frames = 40});
  const auto flags = ml::foot_contacts(walk);
  REQUIRE(flags.size() == 160);
  for (ml::Index f = 0; f + 1 < walk.frames(); ++f) {
    for (std::size_t k = 0; k < 4; ++k) {
      const auto [joint, height] = ml::smpl_contact_joints[k];
      const auto a = place(walk, f, joint), b = place(walk, f + 1, joint);
      const double speed = std::hypot(b.x - a.x, b.z - a.z) * walk.fps;
      CHECK((flags[static_cast<std::size_t>(f) * 4 + k] != 0) == (a.y < height && speed < 0.6));
    }
  }
  CHECK(std::count(flags.begin(), flags.end(), 1) > 40);
  const ml::ContactJoint wrong[] = {{24, 0.1}};
  CHECK_THROWS_WITH_AS(ml::foot_contacts(walk, wrong), Contains("joint 24 of 24"), ml::shape_error);
}

TEST_CASE("a path that drifts over standing feet is put right") {
  auto still = synthetic::walk({.frames = 1});
  for (int f = 1; f < 40; ++f) {
    still.root.push_back(still.root[0]);
    still.local.insert(still.local.end(), still.local.begin(), still.local.begin() + 24);
  }
  const auto fixed = ml::path_from_feet(drifting(still, 0.4));
  for (ml::Index f = 0; f < 40; ++f) CHECK(ml::norm(fixed.root_at(f) - still.root_at(f)) < 1e-9);
}

TEST_CASE("a figure that flies low over the floor, faster than feet slide, is not stopped") {
  const auto fast = drifting(synthetic::walk({.frames = 30}), 6);
  CHECK(synthetic::largest_distance(ml::path_from_feet(fast), fast) < 1e-9);
}

TEST_CASE("a walk that slides slides no more, and goes where it went") {
  const auto walk = synthetic::walk({.frames = 80});
  const auto sliding = drifting(walk, 0.3);
  const auto fixed = ml::fix_feet(sliding);
  CHECK(skate(sliding) > 0.3);
  CHECK(skate(fixed) < 0.5 * skate(sliding));
  CHECK(std::abs(fixed.root_at(79).x - walk.root_at(79).x) < 0.1);  // the drift alone was 1.2 m
  CHECK(std::abs(fixed.root_at(79).z - walk.root_at(79).z) < 0.2);
  CHECK(ml::bone_length_deviation({fixed.positions(), 24, 20}, fixed.skeleton.parents) < 1e-9);
  for (ml::Index f = 0; f < 80; ++f) CHECK(fixed.root_at(f).y == walk.root_at(f).y);
}

TEST_CASE("KIT's joints have legs, too") {
  CHECK(ml::known_legs(ml::smpl24_skeleton()).data() == ml::smpl_legs);
  CHECK(ml::known_legs(ml::humanml3d22_skeleton()).data() == ml::smpl_legs);
  auto other = ml::kit21_skeleton();
  other.names[5] = "arm";
  CHECK(ml::known_legs(other).empty());
  const auto walk = ml::retarget(synthetic::walk({.frames = 80}), ml::kit21_skeleton());
  const auto sliding = drifting(walk, 0.3), fixed = ml::fix_feet(sliding, ml::known_legs(walk.skeleton));
  const std::vector<ml::ContactJoint> feet{{13, ml::smpl_ankle_contact},
                                           {18, ml::smpl_ankle_contact},
                                           {15, ml::smpl_toe_contact},
                                           {20, ml::smpl_toe_contact}};
  const double before = ml::motion_quality(sliding, feet).feet.speed;
  CHECK(before > 0.3);
  CHECK(ml::motion_quality(fixed, feet).feet.speed < 0.5 * before);
  CHECK(std::abs(fixed.root_at(79).x - walk.root_at(79).x) < 0.1);
  CHECK(ml::bone_length_deviation({fixed.positions(), 21, 20}, fixed.skeleton.parents) < 1e-9);
}

TEST_CASE("a clip whose feet do not slide hardly changes; one in the air and one of a frame stay as they are") {
  const auto walk = synthetic::walk({.frames = 60});
  auto high = drifting(walk, 0.3);
  for (auto& root : high.root) root.y += 1;
  CHECK(synthetic::largest_distance(ml::fix_feet(high), high) < 1e-9);
  CHECK(synthetic::largest_distance(ml::fix_feet(walk), walk) <
        0.06);  // the heel that comes off the floor slides a little
  const auto one = synthetic::walk({.frames = 1});
  CHECK(synthetic::largest_distance(ml::fix_feet(one), one) == 0);
}

TEST_CASE("who turns on both feet does not turn; who steps does") {
  ml::Motion stand = synthetic::walk({.frames = 1});
  std::fill(stand.local.begin(), stand.local.end(), ml::Quaternion<double>::identity());  // a T-pose
  stand.root[0] = {0, 0, 0};
  stand.root[0].y = 0.02 - stand.positions()[10].y;
  ml::Motion turntable = stand;
  for (int f = 1; f < 40; ++f) {
    turntable.root.push_back(stand.root[0]);
    turntable.local.insert(turntable.local.end(), stand.local.begin(), stand.local.end());
    turntable.rotations(f)[0] = synthetic::about_y(0.05 * f);
  }
  const auto turned = [](const ml::Motion& m) {
    return ml::distance(m.rotations(0)[0], m.rotations(m.frames() - 1)[0]) * 180 / std::numbers::pi;
  };
  CHECK(turned(turntable) > 110);
  CHECK(turned(ml::turn_from_feet(turntable)) < 40);  // 15 degrees in each of two seconds
  CHECK(turned(ml::turn_from_feet(turntable, ml::smpl_legs, {.pivot = 1000})) > 110);
  const auto walk = synthetic::walk({.frames = 60, .turn = 0.6});
  CHECK(synthetic::largest_distance(ml::turn_from_feet(walk), walk) < 0.05);
  CHECK(ml::turn_from_feet(walk, std::span(ml::smpl_legs).first(1)).root == walk.root);
}

TEST_CASE("feet that swing along the floor are raised over it; where they stand and go stays") {
  // It stands at rest, is carried 1 m ahead in ten steps with its feet on the floor, and stands again.
  ml::Motion clip{ml::smpl24_skeleton(), 20, {}, std::vector(30 * 24, ml::Quaternion<double>::identity()), {}};
  clip.root.resize(30);
  const ml::Vec3<double> start{0, 0.02 - place(clip, 0, 10).y, 0};
  auto ahead = [&](auto way) {
    for (int f = 0; f < 30; ++f) clip.root[static_cast<std::size_t>(f)] = start + ml::Vec3{0.0, 0.0, way(f)};
  };
  ahead([](int f) { return 0.1 * std::clamp(f - 10, 0, 10); });
  const auto fixed = ml::raise_swings(clip, ml::smpl_legs, {.clearance = 0.05});
  for (const int toe : {10, 11}) {
    for (ml::Index f = 0; f < 30; ++f) {
      const auto moved = place(fixed, f, toe) - place(clip, f, toe);
      CHECK(std::abs(moved.x) < 1e-9);
      CHECK(std::abs(moved.z) < 1e-9);
      if (f <= 10 || f >= 20) CHECK(moved.y == 0);
    }
    CHECK(place(fixed, 15, toe).y - place(clip, 15, toe).y == Approx(0.05));
    CHECK(place(fixed, 12, toe).y > place(fixed, 11, toe).y);
  }
  CHECK(synthetic::largest_distance(ml::raise_swings(clip, ml::smpl_legs, {.clearance = 0}), clip) == 0);
  // One that only trembles is raised by a tenth of its way.
  ahead([](int f) { return f == 14 ? 0.03 : 0.0; });
  CHECK(place(ml::raise_swings(clip), 14, 10).y - place(clip, 14, 10).y == Approx(0.006));
}

TEST_CASE("a straight leg bends its knee to where the toes point, whatever the rest pose faces") {
  for (const double turn : {0.0, 0.5 * std::numbers::pi, std::numbers::pi}) {
    ml::Skeleton skeleton = ml::smpl24_skeleton();
    for (auto& o : skeleton.offsets) o = rotate(synthetic::about_y(turn), o);
    ml::Motion standing{skeleton, 20, {}, {}, {}};
    standing.root.assign(2, skeleton.offset(0));
    standing.local.assign(48, ml::Quaternion<double>::identity());
    const std::vector<ml::Vec3<double>> raised(2, ml::Vec3<double>{0, 0.1, 0});
    const ml::Vec3<double> knee = place(standing, 0, 4), toes = place(standing, 0, 10) - place(standing, 0, 7);
    ml::detail::move_foot(standing, ml::smpl_legs[0], raised);
    const ml::Vec3<double> went = place(standing, 0, 4) - knee;
    CAPTURE(turn);
    CHECK(dot(normalized(ml::Vec3<double>{went.x, 0, went.z}), normalized(ml::Vec3<double>{toes.x, 0, toes.z})) > 0.99);
  }
}
