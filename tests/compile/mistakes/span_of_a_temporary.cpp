// SPDX-License-Identifier: MIT
// A view of a tensor that is gone at the end of the statement: the pool hands its memory to the next one.
// expect: deleted
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/ops.hpp>

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

float first_of_twice(const ml::Tensor<B, 1>& a) {
#ifdef MISTAKE
  const auto numbers = (a * 2.0).span();
#else
  const auto twice = a * 2.0;
  const auto numbers = twice.span();
#endif
  return numbers[0];
}
