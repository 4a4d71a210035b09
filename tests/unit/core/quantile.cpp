// Values by their rank.
#include <doctest/doctest.h>

#include <motionlang/core/quantile.hpp>

namespace ml = motionlang;

TEST_CASE("values by their rank") {
  const std::vector<double> values{5, 1, 4, 2, 3};
  CHECK(ml::nth_smallest(values, 0) == 1);
  CHECK(ml::nth_smallest(values, 4) == 5);
  CHECK(ml::quantile(values, 0.5) == 3);
  CHECK(ml::quantile(values, 0.25) == 2);
  CHECK(ml::quantile(values, 0.24) == 1);  // rounded down
  CHECK(ml::quantile(values, 1) == 5);
  CHECK(ml::quantile({}, 0.5) == 0);
}
