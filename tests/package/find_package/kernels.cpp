// SPDX-License-Identifier: MIT
// A user of motionlang::instantiated: links only if the library holds the kernels, fails unless their product is right.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/tensor/ops.hpp>

namespace ml = motionlang;

int main() {
  using Matrix = ml::Tensor<ml::EigenBackend<float>, 2>;
  const Matrix product = ml::matmul(Matrix::full({2, 3}, 2), Matrix::full({3, 4}, 0.5));
  for (const float value : product.span()) {
    if (value != 3) return 1;
  }
  return product.shape() == ml::Shape{2, 4} ? 0 : 1;
}
