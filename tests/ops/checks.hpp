// The checks that every backend runs over the table, and those of numbers that the table does not draw.
#pragma once

#include <doctest/doctest.h>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/reference.hpp>

#include "table.hpp"

namespace table {

/// Every row equals the reference backend in double, within a tolerance of the scalar.
template <ml::Backend B>
void check_parity(double tolerance) {
  using R = ml::ReferenceBackend<double>;
  const auto ours = rows<B>();
  const auto reference = rows<R>();
  for (std::size_t i = 0; i < ours.size(); ++i) {
    INFO(ours[i].name);
    const auto values = draw(ours[i].inputs, ours[i].domain, i + 1);
    const auto inputs = tensors<B>(values, ours[i].inputs);
    const auto got = ours[i].run(inputs);
    const auto want = reference[i].run(tensors<R>(values, reference[i].inputs));
    REQUIRE(B::shape(got) == R::shape(want));
    double worst = 0;
    for (std::size_t j = 0; j < R::to_span(want).size(); ++j) {
      const double w = R::to_span(want)[j], g = static_cast<double>(B::to_span(got)[j]);
      worst = std::max(worst, std::abs(g - w) / (1 + std::abs(w)));
      if (std::isnan(g)) worst = 1e300;
    }
    CHECK(worst < tolerance);
    for (std::size_t t = 0; t < inputs.size(); ++t) {  // operands are never changed visibly
      bool same = true;
      for (std::size_t j = 0; j < values[t].size(); ++j)
        same = same && static_cast<double>(B::to_span(inputs[t])[j]) == values[t][j];
      CHECK(same);
    }
  }
}

/// erf, every nonlinearity and softmax of t, one behind the other.
template <ml::Backend B>
std::vector<double> nonlinear_results(const ml::Tensor<B, 2>& t) {
  std::vector<double> out;
  const auto append = [&](const auto& y) { out.insert(out.end(), y.span().begin(), y.span().end()); };
  append(ml::Tensor<B, 2>(B::erf(t.data())));
  for (ml::Activation act : {ml::Activation::relu, ml::Activation::gelu, ml::Activation::silu, ml::Activation::tanh,
                             ml::Activation::quick_gelu, ml::Activation::gelu_new, ml::Activation::sigmoid})
    append(ml::activate(t, act));
  append(ml::softmax(t));
  return out;
}

/// NaN stays NaN: nonlinearities keep it where it is, softmax spreads it over its row and attention over its sequence,
/// as the reference does. At every place of a vector, and behind the last whole one.
template <ml::Backend B>
void check_not_a_number() {
  constexpr Index width = 37;
  const auto run = [](auto backend, const std::vector<double>& x) {
    using C = decltype(backend);
    using S = typename C::scalar;
    const auto t = ml::Tensor<C, 2>::from(std::vector<S>(x.begin(), x.end()), {3, width});
    auto out = nonlinear_results(t);
    const auto mixed = ml::attention(t, t, t, ml::Offsets{1, 2}, ml::Offsets{1, 2}, {});
    out.insert(out.end(), mixed.span().begin(), mixed.span().end());
    for (double& v : out) v = std::isnan(v);
    return out;
  };
  const std::vector<double> x(3 * width, 0.5);
  for (Index at = 0; at < width; ++at) {
    auto values = x;
    values[static_cast<std::size_t>(width + at)] = std::nan("");
    CHECK(run(B{}, values) == run(ml::ReferenceBackend<double>{}, values));
  }
}

/// Far from 0, where fits end and exponentials leave the range of the scalar: nonlinearities and softmax are what the
/// reference says, and the slope of gelu is 0 or 1.
template <ml::Backend B>
void check_far_numbers(double tolerance) {
  const std::vector<double> x{5.5, 5.65, 5.66, 7, 10, 40, 86.9, 87.1, 88.1, 104, 709, 746, 1e4, 1e7, 1e20};
  const auto run = [&](auto backend) {
    using C = decltype(backend);
    using S = typename C::scalar;
    std::vector<S> both;
    for (double sign : {1.0, -1.0}) {
      for (double v : x)
        both.push_back(static_cast<S>(sign * static_cast<float>(v)));  // the same number in all scalars
    }
    return nonlinear_results(ml::Tensor<C, 2>::from(both, {2, std::ssize(x)}));
  };
  const auto ours = run(B{}), reference = run(ml::ReferenceBackend<double>{});
  REQUIRE(ours.size() == reference.size());
  double worst = 0;
  for (std::size_t i = 0; i < ours.size(); ++i)
    worst =
        std::max(worst, std::isnan(ours[i]) ? 1e300 : std::abs(ours[i] - reference[i]) / (1 + std::abs(reference[i])));
  CHECK(worst < tolerance);

  using S = typename B::scalar;
  CHECK(std::signbit(ml::activate(ml::Tensor<B, 1>::from(std::vector<S>{S(-0.0)}, {1}), ml::Activation::tanh).item()));
  const auto far = ml::Tensor<B, 1>::from(std::vector<S>{S(-1e20), S(-88), S(-10), S(10), S(88), S(1e20)}, {6});
  const ml::Tensor<B, 1> slope(
      B::activate_vjp(far.data(), ml::Tensor<B, 1>::full({6}, S(1)).data(), ml::Activation::gelu));
  for (Index i = 0; i < 6; ++i)
    CHECK(std::abs(static_cast<double>(slope.span()[static_cast<std::size_t>(i)]) - (i < 3 ? 0 : 1)) < tolerance);
}

/// Gradients of a random projection of every row against central differences, in double.
template <ml::Backend B>
void check_derivatives() {
  static_assert(sizeof(typename B::scalar) == 8, "differences need double");
  using A = ml::Autodiff<B>;
  const auto plain = rows<B>();
  const auto taped = rows<A>();
  for (std::size_t i = 0; i < taped.size(); ++i) {
    INFO(taped[i].name);
    auto values = draw(taped[i].inputs, taped[i].domain, i + 1);
    std::vector<typename A::tensor> variables;
    for (auto& t : tensors<B>(values, taped[i].inputs)) variables.push_back(A::variable(t));
    const auto result = taped[i].run(variables);
    const Shape shape = A::shape(result);
    std::vector<double> weight(static_cast<std::size_t>(shape.count()));
    ml::Philox rng{.seed = 1000 + i};
    rng.normal(std::span<double>(weight));
    const auto projected = A::mul(result, A::from_span(std::span<const double>(weight), shape));
    const auto gradients = A::gradients(A::sum(A::reshape(projected, Shape{shape.count()}), 0));
    auto loss = [&] {
      const auto out = plain[i].run(tensors<B>(values, plain[i].inputs));
      double total = 0;
      for (std::size_t j = 0; j < weight.size(); ++j) total += weight[j] * B::to_span(out)[j];
      return total;
    };
    for (std::size_t t = 0; t < variables.size(); ++t) {
      const auto g = gradients.find(variables[t].node.get());
      std::vector<double> zero(values[t].size());
      const auto got = g == gradients.end() ? std::span<const double>(zero) : B::to_span(g->second);
      REQUIRE(got.size() == values[t].size());
      const std::size_t stride = values[t].size() / 40 + 1;  // at most 40 elements of an input
      for (std::size_t j = 0; j < values[t].size(); j += stride) {
        const double x = values[t][j], h = 1e-5;
        values[t][j] = x + h;
        const double up = loss();
        values[t][j] = x - h;
        const double down = loss();
        values[t][j] = x;
        const double numeric = (up - down) / (2 * h);
        CHECK_MESSAGE(std::abs(got[j] - numeric) < 1e-6 * (1 + std::abs(numeric)), "input ", t, " element ", j, ": ",
                      got[j], " but ", numeric);
      }
    }
  }
}

}  // namespace table
