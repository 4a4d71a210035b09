// Decimal places as Python and NumPy round them.
#include <limits>

#include <motionlang/core/rounding.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

TEST_CASE("python_round: of the binary value; numpy_round: of the product") {
  CHECK(ml::python_round(2.675, 2) == 2.67);  // the number is 2.67499999999999982...
  CHECK(ml::numpy_round(2.675, 2) == 2.68);
  for (const auto& round : {ml::python_round, ml::numpy_round}) {
    CHECK(round(3.125, 2) == 3.12);  // halves to the even place
    CHECK(round(3.375, 2) == 3.38);
    CHECK(round(-1.5, 0) == -2);
    CHECK(round(1e300, 2) == doctest::Approx(1e300));
    CHECK(std::isnan(round(std::numeric_limits<double>::quiet_NaN(), 2)));
    CHECK_ERROR(round(1.0, -1), "[motionlang.config.101]");
    CHECK_ERROR(round(1.0, 16), "[motionlang.config.101]");
  }
}
