#include <motionlang/backend/eigen.hpp>

#include "../../examples/11_own_backend/counting_backend.hpp"
#include "checks.hpp"

namespace ml = motionlang;

TEST_CASE("an own backend in float and double") {
  table::check_parity<CountingBackend<ml::EigenBackend<float>>>(3e-5);
  table::check_parity<CountingBackend<ml::EigenBackend<double>>>(1e-13);
}
TEST_CASE("derivatives over an own backend") { table::check_derivatives<CountingBackend<ml::EigenBackend<double>>>(); }
