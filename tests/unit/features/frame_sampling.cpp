// Which frames and joints the published systems take: corner cases and what is refused. Their numbers are golden cases.
#include <doctest/doctest.h>

#include <cmath>  // INFINITY

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/features/joint_sets.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"

namespace ml = motionlang;
using lists::view;
using Frames = std::vector<ml::Index>;

TEST_CASE("frames at other rates") {
  CHECK(ml::every_nth_frame(5, 120, 50) == Frames{0, 2, 4});  // 60 frames per second, not 50
  CHECK(ml::every_nth_frame(0, 120, 50).empty());
  CHECK(ml::spread_frames(10, 30, 15) == Frames{0, 2, 4, 6, 9});
  CHECK(ml::spread_frames(3, 30, 30) == Frames{0, 1, 2});
  CHECK(ml::spread_frames(2, 100, 50) == Frames{0});
  CHECK(ml::spread_frames(2, 100, 30).empty());
  CHECK_ERROR(ml::every_nth_frame(5, 10, 20), "[motionlang.config.101] every_nth_frame: from 10 up to 20");
  CHECK_ERROR(ml::every_nth_frame(5, 10, 0), "[motionlang.config.101] every_nth_frame: 10 to 0");
  CHECK_ERROR(ml::spread_frames(5, -1, 30), "[motionlang.config.101]");
  CHECK_ERROR(ml::spread_frames(5, 30, INFINITY), "[motionlang.config.101] spread_frames: 30 to inf");
}

TEST_CASE("values between frames") {
  const std::vector<float> values{0, 10, 4, 30};
  CHECK(ml::upsample_linearly(view(values), 2, 10, 20) == std::vector<double>{0, 10, 2, 20, 4, 30});
  CHECK(ml::upsample_linearly(view(values), 4, 10, 20) == std::vector<double>{0, 10, 4, 30});
  CHECK(ml::upsample_linearly(std::span<const float>{}, 4, 10, 20).empty());
  const auto eight = ml::upsample_linearly(view(values), 2, 12.5, 100);
  CHECK(eight.size() == 18);
  for (std::size_t k = 0; k < 2; ++k) CHECK(eight[16 * k] == static_cast<double>(values[2 * k]));  // frames stay
  CHECK_ERROR(ml::upsample_linearly(view(values), 3, 10, 20), "[motionlang.shape.205] upsample_linearly: 4 values");
  CHECK_ERROR(ml::upsample_linearly(view(values), 2, 20, 10),
              "[motionlang.config.101] upsample_linearly: from 20 down to 10");
}

TEST_CASE("slices of seconds") {
  CHECK(ml::slice_of_seconds(0, 1, 20, 100) == ml::FrameSlice{0, 20});
  CHECK(ml::slice_of_seconds(4.5, 9, 20, 100) == ml::FrameSlice{90, 10});
  CHECK(ml::slice_of_seconds(6, 9, 20, 100) == ml::FrameSlice{});
  CHECK(ml::slice_of_seconds(1, 1, 20, 100).length == 0);
  CHECK_ERROR(ml::slice_of_seconds(-1, 1, 20, 100), "[motionlang.config.101] slice_of_seconds: -1 to 1 seconds at 20");
  CHECK_ERROR(ml::slice_of_seconds(0, INFINITY, 20, 100), "[motionlang.config.101] slice_of_seconds: 0 to inf");
}

TEST_CASE("actor: frames of a training item") {
  ml::PythonRandom random(3);
  CHECK(ml::actor_frames(3, {.frames = 5}, random) == Frames{0, 1, 2, 2, 2});
  CHECK(ml::actor_frames(4, {.frames = 4}, random) == Frames{0, 1, 2, 3});
  CHECK(ml::actor_frames(10, {.frames = 4, .step = -1}, random) == Frames{0, 3, 6, 9});
  bool last_start = false, first_start = false, wide = false, uneven = false, last_of_any = false;
  for (int i = 0; i < 300; ++i) {
    const auto close = ml::actor_frames(10, {.frames = 4}, random);
    CHECK(close[3] == close[0] + 3);
    first_start |= close[0] == 0, last_start |= close[3] == 9;
    const auto drawn = ml::actor_frames(10, {.frames = 4, .random_step = true}, random);
    CHECK(drawn[3] <= 9);
    CHECK(drawn[1] - drawn[0] == drawn[3] - drawn[2]);
    wide |= drawn[1] - drawn[0] == 3;
    const auto any = ml::actor_frames(10, {.frames = 4, .scattered = true}, random);
    CHECK(any.size() == 4);
    for (std::size_t k = 0; k + 1 < any.size(); ++k) CHECK(any[k] < any[k + 1]);
    CHECK((any[0] >= 0 && any[3] <= 9));
    uneven |= any[1] - any[0] != any[2] - any[1];
    last_of_any |= any[3] == 9;
  }
  CHECK(uneven);
  CHECK(last_of_any);
  CHECK(ml::actor_frames(4, {.frames = 4, .scattered = true}, random) == Frames{0, 1, 2, 3});
  CHECK(ml::actor_frames(2, {.frames = 3, .scattered = true}, random) == Frames{0, 1, 1});
  CHECK(first_start);
  CHECK(!last_start);  // as published
  CHECK(wide);
  CHECK_ERROR(ml::actor_frames(10, {.frames = 1}, random),
              "[motionlang.config.101] actor_frames: 1 of 10 frames, step 1");
  CHECK_ERROR(ml::actor_frames(0, {}, random), "[motionlang.config.101]");
  CHECK_ERROR(ml::actor_frames(9, {.frames = 3, .step = 0}, random), "[motionlang.config.101]");
}

TEST_CASE("joint sets: units, axes, and where the root stands") {
  std::vector<ml::Vec3<double>> points(73);
  for (std::size_t i = 0; i < 73; ++i) points[i] = {0.01 * static_cast<double>(i), 1, 2};
  const std::vector<ml::Vec3<double>> trans{{5, 6, 7}};
  for (const char* name : {"mmm", "mmmns", "smplmmm", "smplnh", "smplh"}) {
    CHECK(ml::select_joints(name, view(points), view(trans))[0] == trans[0]);
  }
  // Joint 1 of MMM is spine1, point 3: 3 cm along x.
  auto way = [&](const char* name) {
    const auto joints = ml::select_joints(name, view(points), view(trans));
    return joints[1] - joints[0];
  };
  CHECK(norm(way("smplmmm") - ml::Vec3{0.03, 0.0, 0.0}) < 1e-12);
  CHECK(norm(way("mmmns") - ml::Vec3{0.0, 0.0, -0.03}) < 1e-12);
  CHECK(norm(way("mmm") - ml::Vec3{0.0, 0.0, -0.03 * 640}) < 1e-9);
  CHECK(norm(way("smplnh") - ml::Vec3{0.01, 0.0, 0.0}) < 1e-12);
  CHECK(ml::select_joints("smplnh", view(points), view(trans)).size() == 22);
  CHECK(ml::select_joints("smplh", std::span<const ml::Vec3<double>>{}, {}).empty());
  CHECK_ERROR(ml::select_joints("kit", view(points), view(trans)), "[motionlang.config.103] select_joints: 'kit'");
  CHECK_ERROR(ml::select_joints("mmm", view(points).first(72), view(trans)),
              "[motionlang.shape.205] select_joints: 72 points for 1 frames of 73");
}
