// SPDX-License-Identifier: MIT
/// Laws of AutodiffBackend. f, g are numbers computed from a variable x, Df the gradient of f:
///
///     value        what is computed equals what the inner backend computes
///     linear       D(a f + b g) = a Df + b Dg
///     product      D(f g) = g Df + f Dg
///     movement     D sum(w * move(x)) = move^-1(w), bit by bit
///     constants    have no gradient, and none passes through stop_gradient
#pragma once

#include <doctest/doctest.h>

#include <motionlang/backend/autodiff.hpp>

#include "../support/tensors.hpp"

namespace laws {

namespace ml = motionlang;

template <ml::AutodiffBackend A>
void autodiff_laws() {
  using B = typename A::inner;
  using X = ml::Tensor<A, 2>;
  using tensors::distance, tensors::same_bits;
  const double tolerance = 8 * tensors::tolerance<typename A::scalar>;
  const auto values = tensors::normal<B, 2>({4, 6}, 1), weights = tensors::normal<B, 2>({4, 6}, 2);
  const auto x = ml::variable<A>(values);

  const auto compute = []<class T>(const T& t) {
    const auto y = ml::matmul(t, ml::softmax(t), {.transpose_b = true});
    return ml::tanh(y) * 2.0 - ml::exp(ml::where_less(y, y * y, y, -y));
  };
  CHECK(distance(compute(x), compute(values)) < tolerance);

  const auto f = [](const X& t) { return ml::sum(ml::sin(t) * t); };
  const auto g = [](const X& t) { return ml::mean(ml::exp(t)); };
  const auto gradient = [&](const ml::Tensor<A, 0>& loss) { return ml::backward(loss)[x]; };
  const auto df = gradient(f(x)), dg = gradient(g(x));
  CHECK(distance(gradient(f(x) * 3.0 - g(x) * 0.5), df * 3.0 - dg * 0.5) < tolerance);
  const auto fv = ml::value_of(f(x)), gv = ml::value_of(g(x));
  CHECK(distance(gradient(f(x) * g(x)), df * gv + dg * fv) < 4 * tolerance);

  const ml::Tensor<A, 2> w(typename A::tensor{weights.data(), nullptr});
  CHECK(same_bits(gradient(ml::sum(w * x)), weights));
  CHECK(same_bits(gradient(ml::sum(ml::transpose(w) * ml::transpose(x))), weights));
  CHECK(same_bits(gradient(ml::sum(ml::reshape<1>(w, {24}) * ml::reshape<1>(x, {24}))), weights));
  const std::vector<ml::Index> order{2, 0, 3, 1};
  CHECK(same_bits(gradient(ml::sum(ml::gather(w, order) * ml::gather(x, order))), weights));

  const auto gradients = ml::backward(ml::sum(w * x));
  CHECK(gradients.find(w.data()) == nullptr);
  CHECK(ml::backward(ml::sum(ml::stop_gradient(x) * w)).find(x.data()) == nullptr);
  CHECK(same_bits(gradient(ml::sum(ml::stop_gradient(x) * x)), values));
}

}  // namespace laws
