#include "checks.hpp"

namespace ml = motionlang;

TEST_CASE("reference backend in float") { table::check_parity<ml::ReferenceBackend<float>>(3e-5); }
TEST_CASE("derivatives of the primitives, and of the definitions of fused operations") {
  table::check_derivatives<ml::ReferenceBackend<double>>();
}
