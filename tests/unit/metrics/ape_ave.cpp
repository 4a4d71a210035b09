// Position errors of motions whose errors are known.
#include <motionlang/metrics/ape_ave.hpp>

#include "../../support/check_error.hpp"
#include "../../support/lists.hpp"

namespace ml = motionlang;
using doctest::Approx;
using Joints = std::vector<ml::Vec3<double>>;

namespace {

/// 22 joints, Z up: hips and shoulders across x, so that SINC's heading is the same in every frame; the rest at the
/// root. All joints go along x by `speed` each frame, and up by f(t).
template <class F>
Joints walk(int frames, double speed, F height) {
  Joints out;
  for (int t = 0; t < frames; ++t) {
    for (int j = 0; j < 22; ++j) {
      const double side = j == 1 || j == 16 ? 0.2 : j == 2 || j == 17 ? -0.2 : 0;
      const bool foot = j == 7 || j == 8 || j == 10 || j == 11;
      out.push_back({3 + side + speed * t, 5, foot ? 0.0 : 1 + height(t)});
    }
  }
  return out;
}
const auto level = [](int) { return 0.0; };

}  // namespace

TEST_CASE("ApeAveMetric: the same motion elsewhere has no error") {
  ml::ApeAveMetric<double> metric(ml::sinc_rifke());
  auto moved = walk(6, 0.1, level);
  for (auto& p : moved) p = p + ml::Vec3<double>{4, -2, 0.5};
  metric.add(walk(6, 0.1, level), moved);
  const auto e = metric.result();
  for (const ml::PositionErrors* part : {&e.ape, &e.ave}) {
    CHECK(part->root == Approx(0));
    CHECK(part->trajectory == Approx(0));
    CHECK(part->mean_local() == Approx(0));
    CHECK(part->mean_joints() == Approx(0));
  }
}

TEST_CASE("ApeAveMetric: one that stands against one that walks") {
  // At 0.1 a frame, frame t is off by 0.1 t: 0, 0.1, 0.2 -> 0.1. The variance of x is 0.01 over three frames.
  ml::ApeAveMetric<double> metric(ml::sinc_rifke(), 10);
  metric.add(walk(3, 0, level), walk(5, 0.1, level));  // cut to three frames
  auto e = metric.result();
  CHECK(e.ape.root == Approx(1));
  CHECK(e.ape.trajectory == Approx(1));
  CHECK(e.ape.mean_local() == Approx(0));
  CHECK(e.ape.mean_joints() == Approx(1));
  CHECK(e.ape.joints.size() == 22);
  CHECK(e.ape.local.size() == 21);
  CHECK(e.ave.root == Approx(1));
  // A second pair without error: APE is per frame (3 of 9), AVE per clip (1 of 2).
  metric.add(walk(6, 0.2, level), walk(6, 0.2, level));
  e = metric.result();
  CHECK(e.ape.root == Approx(1.0 / 3));
  CHECK(e.ave.root == Approx(0.5));
}

TEST_CASE("ApeAveMetric: the best and the worst of several samples") {
  const auto reference = walk(3, 0.1, level), near = walk(3, 0.2, level), far = walk(3, 0.4, level);
  const std::vector<std::span<const ml::Vec3<double>>> samples{far, near};
  ml::ApeAveMetric<double> best(ml::sinc_rifke()), worst(ml::sinc_rifke());
  best.add_best(samples, reference);
  worst.add_worst(samples, reference);
  CHECK(best.result().ape.root == Approx(0.1));
  CHECK(worst.result().ape.root == Approx(0.3));
  const std::vector<ml::ApeAve> both{best.result(), worst.result()};
  CHECK(ml::mean_errors(both).ape.root == Approx(0.2));
  CHECK_ERROR(best.add_best({}, reference), "[motionlang.numeric.302]");
  CHECK_ERROR(ml::mean_errors({}), "[motionlang.numeric.302]");
}

TEST_CASE("ApeAveMetric: padding counts for the floor only") {
  // The floor is that of the lowest foot; frames of zeros below it lift everything that is compared.
  const auto reference = walk(4, 0, level);
  auto padded = reference;
  padded.resize(6 * 22, {0, 0, -1});
  ml::ApeAveMetric<double> metric(ml::sinc_rifke());
  metric.add_padded(padded, reference, 4);
  const double floor = -1 - std::log(0.5 + std::exp(-1.0)), own = -std::log(1.5);
  CHECK(metric.result().ape.root == Approx(own - floor));
  CHECK(metric.result().ape.trajectory == Approx(0));
  CHECK_ERROR(metric.add_padded(padded, reference, 5), "[motionlang.shape.203]");
}

TEST_CASE("ApeAveMetric: nothing, one frame, half a frame") {
  ml::ApeAveMetric<double> metric(ml::sinc_rifke());
  CHECK_ERROR(metric.result(), "[motionlang.numeric.302]");
  CHECK_ERROR(metric.add(walk(1, 0, level), walk(5, 0, level)), "[motionlang.numeric.302]");
  CHECK_ERROR(metric.add(Joints{}, Joints{}), "[motionlang.numeric.302]");
  CHECK_ERROR(metric.add(Joints(30), Joints(22)), "[motionlang.shape.205]");
  CHECK(metric.clips() == 0);
}

TEST_CASE("transition_distance: the mean way of the joints at a frame") {
  const Joints two{{0, 0, 0}, {0, 0, 0}, {3, 4, 0}, {0, 0, 1}};
  CHECK(ml::transition_distance(lists::view(two), 2, 1) == Approx(3));
  CHECK_ERROR(ml::transition_distance(lists::view(two), 2, 0), "[motionlang.shape.203]");
  CHECK_ERROR(ml::transition_distance(lists::view(two), 2, 2), "[motionlang.shape.203]");
  CHECK_ERROR(ml::transition_distance(lists::view(two), 3, 1), "[motionlang.shape.205]");
}
