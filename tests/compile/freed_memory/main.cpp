// SPDX-License-Identifier: MIT
// The address sanitizer sees who uses memory that is back in the pool, until it is taken again.
#include <cstdio>

#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/ops.hpp>

namespace ml = motionlang;
using Tensor = ml::Tensor<ml::ReferenceBackend<float>, 1>;

int main(int arguments, char**) {
  const float* numbers = nullptr;
  {
    const auto a = Tensor::full({1000}, 3);
    numbers = a.span().data();
  }
  if (arguments > 1) std::printf("%g\n", static_cast<double>(numbers[999]));  // the sanitizer ends the program
  const auto b = Tensor::full({1000}, 4);                                     // in the same memory
  std::printf("%s %g\n", b.span().data() == numbers ? "reused" : "elsewhere", static_cast<double>(numbers[999]));
  ml::BufferPool::local().trim();
}
