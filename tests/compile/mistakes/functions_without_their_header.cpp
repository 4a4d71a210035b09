// SPDX-License-Identifier: MIT
// Calculating with features where only the model is included: the bodies of these functions are in a header that
// includes Eigen.
// expect: include <motionlang/backend/eigen.hpp>
#include <motionlang/stmc.hpp>
#ifndef MISTAKE
#include <motionlang/backend/eigen.hpp>
#endif

namespace ml = motionlang;

ml::Tensor<ml::EigenBackend<float>, 2> exponents(const ml::Tensor<ml::EigenBackend<float>, 2>& features) {
  return exp(features);
}
