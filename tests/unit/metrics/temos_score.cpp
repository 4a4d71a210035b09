// The TEMOS score of latents by hand.
#include <motionlang/metrics/temos_score.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using doctest::Approx;

TEST_CASE("temos_score: 1 of the same directions, 0 of opposite ones") {
  const std::vector<double> a{1, 0, 0, 2, 3, 3}, b{5, 0, 0, -1, 1, -1};
  const ml::Rows x(a, 2), y(b, 2);
  const auto d = ml::temos_distances(x, y);
  CHECK(d[0] == Approx(0));
  CHECK(d[1] == Approx(4));
  CHECK(d[2] == Approx(2));
  CHECK(ml::temos_score(x, y) == Approx(0.5));
  CHECK(ml::temos_score(x, x) == Approx(1));
  CHECK_ERROR(ml::temos_score(x, y.slice(0, 2)), "[motionlang.shape.204]");
  CHECK_ERROR(ml::temos_score(x, ml::Rows(b, 3)), "[motionlang.shape.204]");
  CHECK_ERROR(ml::temos_score(x.slice(0, 0), y.slice(0, 0)), "[motionlang.numeric.302]");
}
