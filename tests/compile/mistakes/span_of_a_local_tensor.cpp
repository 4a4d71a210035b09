// SPDX-License-Identifier: MIT
// A function that returns a view of its own tensor. Only Clang sees it.
// compiler: clang
// expect: address of stack memory associated with local variable 'twice' returned
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/ops.hpp>

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

#ifdef MISTAKE
std::span<const float> twice_of(const ml::Tensor<B, 1>& a) {
#else
std::vector<float> twice_of(const ml::Tensor<B, 1>& a) {
#endif
  const auto twice = a * 2.0;
#ifdef MISTAKE
  return twice.span();
#else
  return twice.to_vector();
#endif
}
