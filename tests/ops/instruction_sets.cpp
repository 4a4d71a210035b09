// The kernels of every instruction set that this machine has, not only of the one that would be chosen: the same numbers as the
// reference, and the same bits whatever the batch and the number of threads.
#include <motionlang/backend/eigen.hpp>

#include "../laws/backend_laws.hpp"
#include "../support/kernel_sets.hpp"
#include "checks.hpp"

namespace ml = motionlang;

namespace {

template <class S>
void check_every_kernel(double tolerance) {
  kernel_sets::with_every_kernel<S>([&] {
    table::check_parity<ml::EigenBackend<S>>(tolerance);
    table::check_not_a_number<ml::EigenBackend<S>>();
    table::check_far_numbers<ml::EigenBackend<S>>(tolerance);
    laws::batch_laws<ml::EigenBackend<S>>();
  });
}

}  // namespace

TEST_CASE("portable, AVX2 and AVX-512 kernels agree with the reference") {
  check_every_kernel<float>(3e-5);
  check_every_kernel<double>(1e-13);
}
