// Normalisation of features.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/features/normalizer.hpp>

#include "../../support/tensors.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<double>;

TEST_CASE("there and back, for any rank; a constant feature stays finite") {
  const ml::Normalizer<B> n{ml::Tensor<B, 1>::from({1, -2, 5}, {3}), ml::Tensor<B, 1>::from({2, 0.5, 0}, {3})};
  const auto x = ml::Tensor<B, 2>::from({3, -1, 5, 1, -2, 5}, {2, 3});
  CHECK(tensors::distance(n.normalize(x), ml::Tensor<B, 2>::from({1, 2, 0, 0, 0, 0}, {2, 3})) < 1e-11);
  CHECK(tensors::distance(n.denormalize(n.normalize(x)), x) < 1e-14);
  const auto batch = tensors::normal<B, 3>({2, 4, 3}, 1);
  CHECK(tensors::distance(n.denormalize(n.normalize(batch)), batch) < 1e-3);  // the constant feature is divided by eps
  CHECK(tensors::distance(ml::Normalizer<B>::identity(3).denormalize(x), x) < 1e-11);
}
