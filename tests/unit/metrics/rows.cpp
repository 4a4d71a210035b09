// Rows, distances and cosines.
#include <motionlang/metrics/rows.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using doctest::Approx;

TEST_CASE("Rows: views of whole rows") {
  const std::vector<double> six{1, 2, 3, 4, 5, 6};
  const ml::Rows rows(six, 2);
  CHECK(rows.size() == 3);
  CHECK(rows[2][1] == 6);
  CHECK(rows.slice(1, 2)[0][0] == 3);
  CHECK(ml::rows_at(rows, std::vector<ml::Index>{2, 0, 2}) == std::vector<double>{5, 6, 1, 2, 5, 6});
  CHECK_ERROR(ml::Rows(six, 4), "[motionlang.shape.205]");
  CHECK_ERROR(ml::Rows(six, 0), "[motionlang.shape.205]");
  CHECK_ERROR(rows.slice(2, 2), "[motionlang.shape.203]");
  CHECK_ERROR(ml::rows_at(rows, std::vector<ml::Index>{3}), "[motionlang.shape.203]");
}

TEST_CASE("distances and cosine_similarities: against hand-made vectors") {
  const std::vector<double> a{3, 4, 0, 0}, b{0, 0, 4, -3, 6, 8};
  const ml::Rows x(a, 2), y(b, 2);
  const auto d = ml::distances(x, y);
  CHECK(d[0] == Approx(5));
  CHECK(d[1] == Approx(std::sqrt(50)));
  CHECK(d[5] == Approx(10));
  const auto s = ml::cosine_similarities(x, y);
  CHECK(s[0] == 0);  // a row of zeros is like nothing
  CHECK(s[1] == Approx(0));
  CHECK(s[2] == Approx(1));
  CHECK(s[5] == 0);
  CHECK(ml::similarity_score(0) == 0.5);
  CHECK(ml::paired_distances(x, y.slice(0, 2))[1] == Approx(5));
  CHECK_ERROR(ml::paired_distances(x, y), "[motionlang.shape.204]");
  CHECK_ERROR(ml::distances(x, ml::Rows(b, 3)), "[motionlang.shape.204]");
  CHECK_ERROR(ml::cosine_similarities(x, ml::Rows(b, 3)), "[motionlang.shape.204]");
}
