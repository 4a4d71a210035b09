// The named feature vectors: sizes, and joints and clips that come back.
#include <doctest/doctest.h>

#include <motionlang/features/motion_features.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

namespace {

/// Distances between joints of one frame, which no turn or shift of the world changes.
std::vector<double> spans(std::span<const ml::Vec3<double>> joints, std::size_t frame, std::size_t count) {
  std::vector<double> out;
  for (std::size_t j = 0; j < count; ++j) out.push_back(ml::norm(joints[frame * count + j] - joints[frame * count]));
  return out;
}

}  // namespace

TEST_CASE("every feature vector gives the poses back") {
  for (const ml::MotionFeatures& f : ml::all_motion_features) {
    CAPTURE(f.name);
    const auto motion = synthetic::walk({.frames = 40, .fps = f.fps, .turn = 0.3});
    const auto rows = f.from_motion(motion);
    REQUIRE(std::ssize(rows) % f.width == 0);
    const auto frames = std::ssize(rows) / f.width;
    CHECK(frames == (f.name == "guoh3d" ? 39 : 40));
    const auto joints = f.joints_of(rows);
    REQUIRE(std::ssize(joints) == frames * f.joints);
    const auto truth = ml::detail::first_joints(motion, 22);
    for (const std::size_t frame : {std::size_t{0}, std::size_t{20}, std::size_t{37}}) {
      const auto a = spans(joints, frame, 22), b = spans(truth, frame, 22);
      for (std::size_t j = 0; j < 22; ++j) {
        if (f.name != "guoh3d")  // its bones are those of another body
          CHECK(a[j] == doctest::Approx(b[j]).epsilon(1e-6));
        else
          CHECK(a[j] == doctest::Approx(b[j]).epsilon(0.25));
      }
    }
    // the way over the ground, whatever the units of the body
    auto way = [](std::span<const ml::Vec3<double>> p) {
      const auto d = p[37 * 22] - p[0];
      return std::hypot(d.x, d.z);
    };
    CHECK(way(joints) == doctest::Approx(way(truth)).epsilon(f.name == "guoh3d" ? 0.2 : 1e-6));
    CHECK(joints[0].y == doctest::Approx(truth[0].y).epsilon(0.2));  // upright
  }
}

TEST_CASE("clips come back where the rows have rotations") {
  for (const char* name : {"smplvelp", "smplrifke"}) {
    CAPTURE(name);
    const auto& f = ml::motion_features(name);
    const auto motion = synthetic::walk({.frames = 30, .fps = f.fps});
    const auto rows = f.from_motion(motion);
    REQUIRE((f.to_motion != nullptr));
    const auto back = f.to_motion(rows, f.fps);
    CHECK(back.fps == f.fps);
    CHECK(back.frames() == 30);
    const auto again = f.from_motion(back);
    REQUIRE(again.size() == rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) CHECK(again[i] == doctest::Approx(rows[i]).epsilon(1e-4).scale(0.1));
  }
  CHECK((ml::motion_features("guoh3d").to_motion == nullptr));
}

TEST_CASE("unknown names and other skeletons are refused") {
  CHECK_ERROR(ml::motion_features("guo"), "[motionlang.config.103] motion_features: 'guo' is none of guoh3d, rifke");
  ml::Motion none;
  CHECK_ERROR(ml::motion_features("guoh3d").from_motion(none), "[motionlang.config.103]");
}
