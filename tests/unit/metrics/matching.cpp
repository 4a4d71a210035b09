// R-precision and matching score by hand.
#include <motionlang/metrics/matching.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using doctest::Approx;
using ml::Index;

TEST_CASE("MatchingMetric: ranks inside a batch, sums over batches") {
  const std::vector<double> texts{0, 1, 2, 10}, motions{0, 2, 1, 14};
  ml::MatchingMetric metric;
  metric.add(ml::Rows(texts, 1), ml::Rows(motions, 1));
  // Text 1 at 1 is nearest to motion 2, then as near to motion 0 as to its own, which comes later in the list.
  CHECK(metric.hits(1) == 2);
  CHECK(metric.hits(2) == 3);
  CHECK(metric.hits(3) == 4);
  CHECK(metric.matching_score() == Approx((0 + 1 + 1 + 4) / 4.0));
  metric.add(ml::Rows(texts, 1), ml::Rows(texts, 1));
  CHECK(metric.r_precision(1) == Approx(0.75));
  CHECK(metric.queries() == 8);
  CHECK_ERROR(metric.hits(4), "[motionlang.config.101]");
  CHECK_ERROR(metric.add(ml::Rows(texts, 1), ml::Rows(motions, 2)), "[motionlang.shape.204]");
  const std::vector<double> odd{0, std::nan(""), 1, 2};
  CHECK_ERROR(metric.add(ml::Rows(texts, 1), ml::Rows(odd, 1)), "[motionlang.numeric.301] MatchingMetric");
  CHECK(metric.queries() == 8);
  CHECK_ERROR(ml::MatchingMetric().r_precision(1), "[motionlang.numeric.302]");
  CHECK_ERROR(ml::MatchingMetric().matching_score(), "[motionlang.numeric.302]");
}

TEST_CASE("nearest_first: columns in order, equals as they stand") {
  const std::vector<double> table{2, 1, 1, 0, 3, 5};
  CHECK(ml::nearest_first(ml::Rows(table, 3)) == std::vector<Index>{1, 2, 0, 0, 1, 2});
}
