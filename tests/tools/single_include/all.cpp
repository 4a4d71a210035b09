// SPDX-License-Identifier: MIT
// All generated headers in one unit: what several of them contain must not be defined twice.
#include <motionlang/motionlang_fwd.hpp>
//
#include <motionlang/motionlang_xtensor.hpp>
//
#include <motionlang/stmc.hpp>
//
#include <motionlang/motionlang.hpp>
#include <motionlang/motionlang_eigen.hpp>
#include <motionlang/motionlang_io.hpp>

namespace ml = motionlang;

ml::Index frames_of(const char* text);

int main() {
  using Matrix = ml::Tensor<ml::ReferenceBackend<double>, 2>;
  const bool sums = (Matrix::full({1, 1}, 1) + 2.0).item() == 3;
  const bool reads = ml::parse_json("[1, 2]").size() == 2;
  return sums && reads && frames_of("walk forward # 0.0 # 6.0 # legs\n") == 120 ? 0 : 1;
}
