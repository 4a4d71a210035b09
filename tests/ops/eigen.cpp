#include <motionlang/backend/eigen.hpp>

#include "checks.hpp"

namespace ml = motionlang;

TEST_CASE("eigen backend in float and double") {
  table::check_parity<ml::EigenBackend<float>>(3e-5);
  table::check_parity<ml::EigenBackend<double>>(1e-13);
}
TEST_CASE("derivatives over the eigen backend, hand-written ones included") {
  table::check_derivatives<ml::EigenBackend<double>>();
}
