#include <motionlang/backend/xtensor.hpp>

#include "checks.hpp"

namespace ml = motionlang;

TEST_CASE("xtensor backend in float and double") {
  table::check_parity<ml::XtensorBackend<float>>(3e-5);
  table::check_parity<ml::XtensorBackend<double>>(1e-13);
}
TEST_CASE("derivatives over the xtensor backend, hand-written ones included") {
  table::check_derivatives<ml::XtensorBackend<double>>();
}
