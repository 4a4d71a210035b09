// The kernels of every instruction set that this machine has, not only of the one that would be chosen: the same numbers as the
// reference, and the same bits whatever the batch and the number of threads.
#include <motionlang/backend/eigen.hpp>

#include "../laws/backend_laws.hpp"
#include "checks.hpp"

namespace ml = motionlang;
using ml::detail::Isa;

namespace {

template <class S>
void with_kernels(Isa isa, double tolerance) {
  const auto* wanted = ml::detail::kernels_for<S>(isa);
  if (wanted == nullptr) return;
  const auto* before = std::exchange(ml::detail::current_kernels<S>(), wanted);
  INFO(wanted->name);
  table::check_parity<ml::EigenBackend<S>>(tolerance);
  table::check_not_a_number<ml::EigenBackend<S>>();
  laws::batch_laws<ml::EigenBackend<S>>();
  ml::detail::current_kernels<S>() = before;
}

}  // namespace

TEST_CASE("portable, AVX2 and AVX-512 kernels agree with the reference") {
  for (Isa isa : {Isa::portable, Isa::avx2, Isa::avx512}) {
    with_kernels<float>(isa, 3e-5);
    with_kernels<double>(isa, 1e-13);
  }
}
