// Means with their spread.
#include <motionlang/metrics/summary.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using doctest::Approx;

TEST_CASE("replication_interval: 1.96 standard errors of the population") {
  const auto s = ml::replication_interval(std::vector<double>{1, 3, 1, 3});
  CHECK(s.mean == 2);
  CHECK(s.half_width == Approx(0.98));
  CHECK(ml::replication_interval(std::vector<double>{4}).half_width == 0);
  CHECK_ERROR(ml::replication_interval({}), "[motionlang.numeric.302]");
}

TEST_CASE("actor_summary: 1.96 variances, accuracies in percent") {
  const std::vector<double> values{0.91, 0.935};
  const auto fid = ml::actor_summary("fid_gen", values), accuracy = ml::actor_summary("accuracy_gen", values);
  CHECK(fid.mean == 0.92);  // 0.9225
  CHECK(fid.half_width == 0);
  CHECK(accuracy.mean == 92.2);        // 92.25, to the even place
  CHECK(accuracy.half_width == 3.06);  // 1.96 x 1.5625
  CHECK_ERROR(ml::actor_summary("fid_gen", {}), "[motionlang.numeric.302]");
}
