// Clips in place, paths of their own, blending, loops, smoothing: each against what must come out exactly.
#include <doctest/doctest.h>

#include <limits>
#include <tuple>

#include <motionlang/core/rng.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/loops.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>
#include <motionlang/metrics/motion_quality.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using doctest::Approx;
using Vec = ml::Vec3<double>;

namespace {

/// A walk whose poses repeat after 20 frames.
ml::Motion periodic_walk(int frames, double turn = 0) {
  return synthetic::walk({.frames = frames, .steps_per_second = 2, .turn = turn});
}

/// How much the step into a frame differs from the mean of the steps before and after it; of the worst joint, metres.
double roughness(const ml::Motion& m, ml::Index frame) {
  const auto p = m.positions();
  double worst = 0;
  for (ml::Index j = 0; j < m.skeleton.size(); ++j) {
    auto at = [&](ml::Index f) { return p[static_cast<std::size_t>(f * m.skeleton.size() + j)]; };
    const Vec before = at(frame - 1) - at(frame - 2), over = at(frame) - at(frame - 1),
              after = at(frame + 1) - at(frame);
    worst = std::max(worst, ml::norm(over - 0.5 * (before + after)));
  }
  return worst;
}

ml::Motion trembling(ml::Motion motion, double angle) {
  ml::Philox rng{.seed = 3};
  std::vector<float> noise(motion.local.size() * 3);
  rng.normal(noise);
  for (std::size_t i = 0; i < motion.local.size(); ++i) {
    const Vec v{noise[3 * i], noise[3 * i + 1], noise[3 * i + 2]};
    motion.local[i] = motion.local[i] * ml::to_quaternion(ml::AxisAngle<double>{angle * v});
  }
  return motion;
}

double jitter(const ml::Motion& m) { return ml::motion_quality(m).jitter; }

}  // namespace

TEST_CASE("turn_between finds the turn about the vertical, whatever the axes of the root") {
  for (const auto& q : {ml::Quaternion<double>::identity(), synthetic::about_x(1.2) * synthetic::about_z(-0.4)}) {
    for (const double a : {0.0, 1e-8, 0.7, -2.9, 3.1}) {
      CHECK(ml::turn_between(q, synthetic::about_y(a) * q) == Approx(a).epsilon(1e-12));
      CHECK(ml::turn_between(q, -(synthetic::about_y(a) * q)) == Approx(a).epsilon(1e-12));
    }
  }
  CHECK(ml::turn_between(ml::Quaternion<double>::identity(), synthetic::about_x(0.5)) == Approx(0));
}

TEST_CASE("a clip is moved as a rigid whole") {
  const auto walk = synthetic::walk({.frames = 8, .turn = 0.5});
  const ml::Placement by{0.6, {1, 0, -2}};
  const auto p = walk.positions(), q = ml::placed(walk, by).positions();
  for (std::size_t i = 0; i < p.size(); ++i) CHECK(ml::norm(by(p[i]) - q[i]) < 1e-12);
  const auto back = ml::placement_between(ml::placed(walk, by), 3, walk, 3);
  CHECK(synthetic::largest_distance(ml::placed(ml::placed(walk, by), back), walk) < 1e-12);
}

TEST_CASE("in place: joints stay where they are relative to the root, which stays over the origin") {
  const auto walk = synthetic::walk({.frames = 20, .turn = 0.5});
  const auto p = walk.positions(), q = ml::in_place(walk).positions();
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t root = i / 24 * 24;
    CHECK(ml::norm((p[i] - p[root]) - (q[i] - q[root])) < 1e-12);
    CHECK(q[root] == Vec{0, p[root].y, 0});
  }
  for (const Vec& r : ml::in_place(walk, {.keep_height = false}).root) CHECK(r == Vec{0, walk.root[0].y, 0});
  CHECK(ml::in_place(ml::crop(walk, 0, 0)).frames() == 0);
}

TEST_CASE("root motion: taken out and put back gives the clip; two turns are 4 pi") {
  const auto walk = synthetic::walk({.frames = 150, .turn = 1.8});
  const auto [path, pose] = ml::extract_root_motion(walk);
  CHECK(synthetic::largest_distance(ml::apply_root_motion(pose, path), walk) < 1e-12);
  CHECK(path.heading.front() == 0);
  CHECK(path.heading.back() == Approx(1.8 * 149 / 20).epsilon(0.01));  // the hips swing a little
  CHECK(path.position[70] == Vec{walk.root[70].x, 0, walk.root[70].z});
  for (ml::Index f = 0; f < pose.frames(); ++f) {
    CHECK(pose.root_at(f) == Vec{0, walk.root_at(f).y, 0});
    CHECK(std::abs(ml::turn_between(pose.rotations(0)[0], pose.rotations(f)[0])) < 1e-12);
  }
  CHECK(pose.rotations(0)[0] == walk.rotations(0)[0]);
  CHECK_ERROR(ml::apply_root_motion(ml::crop(pose, 0, 3), path), "[motionlang.shape.204]");
}

TEST_CASE("blend_into: a walk that was cut and moved away is itself again") {
  const auto walk = synthetic::walk({.frames = 60, .turn = 0.3});
  for (const ml::Index overlap : {1, 2, 9}) {
    const auto first = ml::crop(walk, 0, 30);
    const auto second = ml::placed(ml::crop(walk, 30 - overlap, 60), {2.5, {3, 0, 1}});
    const auto joined = ml::blend_into(first, second, overlap);
    CHECK(joined.frames() == 60);
    CHECK(synthetic::largest_distance(joined, walk) < 1e-9);
  }
}

TEST_CASE("blend_into: before and after the blend both clips are as they were, in between it goes gradually") {
  const auto slow = synthetic::walk({.frames = 40}), fast = synthetic::walk({.frames = 40, .steps_per_second = 2.6});
  const auto joined = ml::blend_into(slow, fast, 10);
  REQUIRE(joined.frames() == 70);
  CHECK(synthetic::largest_distance(ml::crop(joined, 0, 30), ml::crop(slow, 0, 30)) == 0);
  CHECK(std::equal(joined.local.begin() + 40 * 24 + 1, joined.local.begin() + 40 * 24 + 24,
                   fast.local.begin() + 10 * 24 + 1));
  const auto way = joined.root_at(60) - joined.root_at(50), expected = fast.root_at(30) - fast.root_at(20);
  CHECK(ml::norm(way) == Approx(ml::norm(expected)));
  // the fifth of nine blended frames is halfway
  const auto nine = ml::blend_into(slow, fast, 9);
  const auto a = slow.rotations(31 + 4)[4], b = fast.rotations(4)[4], middle = nine.rotations(31 + 4)[4];
  CHECK(ml::distance(a, middle) == Approx(ml::distance(b, middle)));
  CHECK_ERROR(ml::blend_into(slow, fast, 0), "[motionlang.config.101]");
  CHECK_ERROR(ml::blend_into(slow, ml::crop(fast, 0, 3), 4), "[motionlang.config.101]");
  CHECK_ERROR(ml::blend_into(slow, ml::resample(fast, 30), 4), "[motionlang.config.102]");
}

TEST_CASE("without_jump: the frame after the jump goes where those before lead, and what that moves fades away") {
  // turns and goes evenly, except a jump into frame 20
  const auto steady = [](const ml::Quaternion<double>& later, double up) {
    ml::Motion m{synthetic::walk({.frames = 1}).skeleton, 20, {}, {}, "steady"};
    for (int f = 0; f < 40; ++f) {
      m.root.push_back({0.05 * f, 1 + (f < 20 ? 0 : up), 0});
      const auto turned = synthetic::about_y(0.1 * f);
      m.local.insert(m.local.end(), 24, f < 20 ? turned : turned * later);
    }
    return m;
  };
  const auto even = steady(ml::Quaternion<double>::identity(), 0), jumping = steady(synthetic::about_x(0.5), 0.4);
  CHECK(synthetic::largest_distance(ml::without_jump(even, 20, 30), even) < 1e-9);
  for (const bool back : {false, true}) {
    CAPTURE(back);
    const auto m = back ? ml::without_jump(jumping, 19, 9) : ml::without_jump(jumping, 20, 30);
    const ml::Index from = back ? 9 : 20, to = back ? 19 : 30, middle = back ? 14 : 25;
    const auto same = [&](ml::Index a, ml::Index b) {
      return synthetic::largest_distance(ml::crop(m, a, b), ml::crop(jumping, a, b)) == 0;
    };
    CHECK((same(0, back ? 10 : 20) && same(back ? 20 : 30, 40)));
    CHECK(ml::norm(m.root_at(20) - m.root_at(19) - Vec{0.05, 0, 0}) < 1e-12);
    CHECK(ml::distance(m.rotations(19)[3], m.rotations(20)[3]) == Approx(0.1));
    for (ml::Index f = from; f <= to; ++f) {
      CHECK(std::abs(m.root_at(f).y - m.root_at(f - 1).y) < 0.061);  // of 0.4 m, with the weights of a smooth step
      CHECK(ml::distance(m.rotations(f)[3], jumping.rotations(f)[3]) < 0.5 + 1e-9);
    }
    CHECK(std::abs(m.root_at(middle).y - jumping.root_at(middle).y) == Approx(0.2));
    CHECK(ml::distance(m.rotations(middle)[3], jumping.rotations(middle)[3]) == Approx(0.25));
  }
  // a clip has nothing before its second frame that would lead on: that frame is held
  CHECK(ml::norm(ml::without_jump(even, 1, 5).root_at(1) - even.root_at(0)) < 1e-12);
  for (const auto& [from, to] : {std::pair{0, 5}, {40, 45}, {39, 41}, {39, 30}, {3, -2}})
    CHECK_ERROR(ml::without_jump(even, from, to), "[motionlang.config.101] without_jump: frames ");
}

TEST_CASE("a loop of a periodic walk is one period of it, and `next` the way of a period") {
  for (const double turn : {0.0, 0.7}) {
    const auto walk = periodic_walk(90, turn);
    const auto clip = ml::crop(walk, 30, 56);  // 20 frames and 6 to blend
    const auto [loop, next] = ml::make_loop(clip, 6);
    REQUIRE(loop.frames() == 20);
    CHECK(synthetic::largest_distance(loop, ml::crop(clip, 0, 20)) < 1e-9);
    CHECK(next.turn == Approx(turn));
    const auto two = ml::concatenate(loop, ml::placed(loop, next));
    CHECK(synthetic::largest_distance(two, ml::crop(walk, 30, 70)) < 1e-9);
  }
}

TEST_CASE("a loop of any clip: the step from its last to its first frame is like its neighbours") {
  const auto walk = periodic_walk(50);
  const auto clip = ml::crop(walk, 0, 44);  // two periods and four frames, of which ten are blended: not periodic
  const auto [loop, next] = ml::make_loop(clip, 10);
  REQUIRE(loop.frames() == 34);
  const auto twice = ml::concatenate(loop, ml::placed(loop, next));
  double usual = 0;
  for (ml::Index f = 12; f < 32; ++f) usual = std::max(usual, roughness(walk, f));
  CHECK(roughness(twice, 34) < 1.5 * usual);
  const auto cut = ml::crop(walk, 0, 34);  // without blending the seam is a jump
  CHECK(roughness(ml::concatenate(cut, ml::placed(cut, next)), 34) > 4 * usual);
  CHECK(synthetic::largest_distance(ml::crop(loop, 10, 34), ml::crop(clip, 10, 34)) == 0);

  const auto still = ml::make_loop(ml::in_place(clip), 10);
  CHECK(ml::norm(still.next.shift) < 1e-12);
  CHECK_ERROR(ml::make_loop(clip, 23), "[motionlang.config.101]");
  CHECK_ERROR(ml::make_loop(clip, 0), "[motionlang.config.101]");
  CHECK_ERROR(ml::make_loop(clip, std::numeric_limits<ml::Index>::max()), "[motionlang.config.101]");
}

TEST_CASE("the cycle of a periodic walk is found, and going round it walks on") {
  for (const double turn : {0.0, 0.7}) {
    const auto walk = periodic_walk(90, turn);
    const auto clip = ml::crop(walk, 0, 45);
    const auto loop = ml::find_loop(clip, 12);
    REQUIRE(loop);
    CHECK((loop->last - loop->first) % 20 == 0);
    CHECK(loop->cost < 1e-9);
    CHECK(synthetic::largest_distance(ml::go_round(clip, *loop, 90), walk) < 1e-6);
    CHECK(ml::go_round(clip, *loop, 30).frames() == 30);
    CHECK_ERROR(ml::go_round(clip, ml::Loop{5, 45}, 90),
                "[motionlang.config.101] go_round: loop 5 ... 45 in 45 frames");
  }
}

TEST_CASE("a clip whose poses never come back has no cycle; one that comes close is joined without a jump") {
  CHECK_ERROR(ml::find_loop(periodic_walk(60), 0), "[motionlang.config.101] find_loop: a cycle of 0 frames");
  CHECK(!ml::find_loop(ml::crop(periodic_walk(60), 0, 15), 12));
  const auto clip = ml::crop(periodic_walk(60), 0, 40);
  const ml::Loop rough{2, 24};  // two frames more than a period
  const auto on = ml::go_round(clip, rough, 60);
  double usual = 0;
  for (ml::Index f = 4; f < 22; ++f) usual = std::max(usual, roughness(clip, f));
  CHECK(roughness(on, 24) < 2 * usual);
  CHECK(roughness(ml::go_round(clip, rough, 60, 1), 24) > 2.5 * usual);  // without blending
}

TEST_CASE("smoothing leaves even and evenly accelerated movement as it is, at the ends too") {
  ml::Motion m{ml::Skeleton::from_joints({{"r", "", {0, 1, 0}}}), 20, {}, {}, ""};
  const Vec axis = ml::normalized(Vec{1.0, 2.0, -1.0});
  for (int f = 0; f < 30; ++f) {
    const double t = f / 20.0;
    m.root.push_back({t, 1 - 2 * t * t, 0.5});
    m.local.push_back(ml::from_axis_angle(axis, 0.3 + 2 * t - 0.8 * t * t));
  }
  const auto smooth = ml::smooth_motion(m, {.sigma = 0.1});
  REQUIRE(smooth.frames() == 30);
  for (std::size_t f = 0; f < 30; ++f) {
    CHECK(ml::norm(smooth.root[f] - m.root[f]) < 1e-12);
    CHECK(ml::distance(smooth.local[f], m.local[f]) < 1e-9);
  }
}

TEST_CASE("smoothing damps as it says: 98 % stay at 2.5 Hz, 82 % at 5 Hz, 35 % at 10 Hz") {
  for (const auto& [hertz, kept] : {std::pair{0.0, 1.0}, {2.5, 0.983}, {5.0, 0.819}, {10.0, 0.354}}) {
    ml::Motion m{ml::Skeleton::from_joints({{"r", "", {0, 1, 0}}}), 20, {}, {}, ""};
    for (int f = 0; f < 81; ++f) {
      const double wave = std::cos(2 * std::numbers::pi * hertz * f / 20.0);
      m.root.push_back({wave, 0, 0});
      m.local.push_back(synthetic::about_z(0.2 * wave));
    }
    const auto smooth = ml::smooth_motion(m);
    CHECK(std::abs(smooth.root[40].x - kept) < 1e-3);
    CHECK(std::abs(ml::log_so3(smooth.local[40]).z / 0.2 - kept) < 1e-3);
  }
}

TEST_CASE("smoothing takes trembling away and keeps the walk") {
  const auto walk = synthetic::walk({.frames = 80});
  const auto rough = trembling(walk, 0.03), smooth = ml::smooth_motion(rough);
  CHECK(jitter(rough) > 3 * jitter(walk));
  CHECK(jitter(smooth) < 0.6 * jitter(rough));
  CHECK(synthetic::largest_distance(ml::smooth_motion(walk), walk) < 0.02);
  CHECK(ml::smooth_motion(walk, {.sigma = 0}).local == walk.local);
  for (const ml::Index frames : {0, 1, 2}) CHECK(ml::smooth_motion(ml::crop(walk, 0, frames)).frames() == frames);
  CHECK(ml::smooth_motion(ml::crop(walk, 0, 2)).root == ml::crop(walk, 0, 2).root);
  CHECK(ml::smooth_motion(walk, {.sigma = 1e300}).frames() == walk.frames());
  CHECK_ERROR(ml::smooth_motion(walk, {.sigma = -1}), "[motionlang.config.101]");
}

TEST_CASE("smoothing does not care which sign a quaternion has") {
  auto walk = synthetic::walk({.frames = 30});
  auto flipped = walk;
  for (std::size_t i = 0; i < flipped.local.size(); i += 7) flipped.local[i] = -flipped.local[i];
  CHECK(synthetic::largest_distance(ml::smooth_motion(flipped), ml::smooth_motion(walk)) < 1e-12);
}

TEST_CASE("resample between any two rates: as many frames as fit, each at its moment") {
  for (const auto& [from, to, frames] : {std::tuple{120.0, 20.0, 21},
                                         {60.0, 24.0, 49},
                                         {60.0, 12.5, 26},
                                         {20.0, 12.5, 76},
                                         {24.0, 60.0, 301},
                                         {29.97, 30.0, 121}}) {
    const auto walk = synthetic::walk({.frames = 121, .fps = from});
    const auto out = ml::resample(walk, to);
    REQUIRE(out.frames() == frames);
    CHECK(static_cast<double>(out.frames() - 1) / to <= 120 / from + 1e-9);
    CHECK(static_cast<double>(out.frames()) / to > 120 / from - 1e-9);
    for (ml::Index i = 0; i < out.frames(); ++i) {
      const double moment = static_cast<double>(i) * from / to;
      const auto a = static_cast<ml::Index>(moment + 1e-6), b = std::min<ml::Index>(a + 1, 120);
      const double t = moment - static_cast<double>(a);
      CHECK(ml::norm(out.root_at(i) - ((1 - t) * walk.root_at(a) + t * walk.root_at(b))) < 1e-9);
    }
  }
}
