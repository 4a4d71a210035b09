// SPDX-License-Identifier: MIT
/// Laws of ScalarLike, up to rounding, for everything that one value holds (eight lanes, a derivative, a whole tensor):
///
///     a + b = b + a        (a + b) + c = a + (b + c)      a + 0 = a        a + (-a) = 0       a - b = a + (-b)
///     a b = b a            (a b) c = a (b c)              1 a = a          a / b b = a        a (b + c) = a b + a c
///     sqrt(a)^2 = a, sqrt(a^2) = |a|                      sin^2 + cos^2 = 1
///     sin(a + b) = sin a cos b + cos a sin b              atan2(r sin a, r cos a) = a         for |a| < pi, r > 0
///     where_less(a, b, x, y) is x or y, y where a = b     where_less(a, b, a, b) + where_less(a, b, b, a) = a + b
///
/// The derivative of a dual number obeys the same equations, which makes them the rules of differentiation.
#pragma once

#include <doctest/doctest.h>

#include <motionlang/core/dual.hpp>
#include <motionlang/core/lane.hpp>
#include <motionlang/tensor/ops.hpp>

#include "../support/tensors.hpp"

namespace laws {

namespace ml = motionlang;

/// How many numbers become values of a scalar-like type, and the numbers that a value holds.
template <class S>
struct Numbers;
template <ml::Scalar S>
struct Numbers<S> {
  using scalar = S;
  static std::vector<S> pack(const std::vector<double>& x) {
    std::vector<S> out;
    for (double v : x) out.push_back(static_cast<S>(v));
    return out;
  }
  static std::vector<double> unpack(S x) { return {static_cast<double>(x)}; }
};
template <ml::Scalar S>
struct Numbers<ml::Dual<S>> {
  using scalar = S;
  static std::vector<ml::Dual<S>> pack(const std::vector<double>& x) {
    std::vector<ml::Dual<S>> out;
    for (std::size_t i = 0; i < x.size(); ++i)
      out.emplace_back(static_cast<S>(x[i]), static_cast<S>(x[(i + 1) % x.size()]));
    return out;
  }
  static std::vector<double> unpack(const ml::Dual<S>& x) {
    return {static_cast<double>(x.value), static_cast<double>(x.derivative)};
  }
};
template <ml::Scalar S, int bytes>
struct Numbers<ml::Lane<S, bytes>> {
  using scalar = S;
  using L = ml::Lane<S, bytes>;
  static std::vector<L> pack(const std::vector<double>& x) {
    std::vector<L> out(x.size() / L::size);
    for (std::size_t i = 0; i < out.size() * L::size; ++i)
      out[i / L::size][static_cast<int>(i % L::size)] = static_cast<S>(x[i]);
    return out;
  }
  static std::vector<double> unpack(const L& x) {
    std::vector<double> out;
    for (int i = 0; i < L::size; ++i) out.push_back(static_cast<double>(x[i]));
    return out;
  }
};
template <ml::Backend B>
struct Numbers<ml::Tensor<B, 1>> {
  using scalar = typename B::scalar;
  static std::vector<ml::Tensor<B, 1>> pack(const std::vector<double>& x) {
    return {ml::Tensor<B, 1>::from(Numbers<scalar>::pack(x), {static_cast<ml::Index>(x.size())})};
  }
  static std::vector<double> unpack(const ml::Tensor<B, 1>& x) { return {x.span().begin(), x.span().end()}; }
};

template <ml::ScalarLike S>
void check_equal(const S& got, const S& want, const char* law) {
  const auto a = Numbers<S>::unpack(got), b = Numbers<S>::unpack(want);
  const std::size_t n = std::max(a.size(), b.size());  // a tensor of one number stands for many
  double worst = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = a[a.size() == 1 ? 0 : i], y = b[b.size() == 1 ? 0 : i];
    worst = std::max(worst, std::isnan(x) ? 1e300 : std::abs(x - y) / (1 + std::abs(y)));
  }
  CHECK_MESSAGE(worst < tensors::tolerance<typename Numbers<S>::scalar>, law);
}

/// 64 numbers between `low` and 3, with either sign unless low is 0.
template <class S>
std::vector<S> scalars(double low, std::uint64_t seed, bool positive = false) {
  ml::Philox rng{.seed = seed};
  std::vector<double> x;
  for (int i = 0; i < 64; ++i) {
    const double size = low + (3 - low) * rng.uniform();
    x.push_back(positive || rng.uniform() < 0.5 ? size : -size);
  }
  return Numbers<S>::pack(x);
}

template <ml::ScalarLike S>
void scalar_laws() {
  using ml::sqrt, ml::sin, ml::cos, ml::atan2, ml::where_less;
  const auto as = scalars<S>(0.2, 1), bs = scalars<S>(0.2, 2), cs = scalars<S>(0.2, 3), rs = scalars<S>(0.2, 4, true);
  const S zero(0.0), one(1.0);
  for (std::size_t i = 0; i < as.size(); ++i) {
    const S &a = as[i], &b = bs[i], &c = cs[i], &r = rs[i];
    check_equal<S>(a + b, b + a, "addition commutes");
    check_equal<S>((a + b) + c, a + (b + c), "addition is associative");
    check_equal<S>(a + zero, a, "a + 0 = a");
    check_equal<S>(a + (-a), zero, "a + (-a) = 0");
    check_equal<S>(a - b, a + (-b), "a - b = a + (-b)");
    check_equal<S>(a * b, b * a, "multiplication commutes");
    check_equal<S>((a * b) * c, a * (b * c), "multiplication is associative");
    check_equal<S>(one * a, a, "1 a = a");
    check_equal<S>(a / b * b, a, "a / b b = a");
    check_equal<S>(a * (b + c), a * b + a * c, "a (b + c) = a b + a c");
    check_equal<S>(sqrt(r) * sqrt(r), r, "sqrt(a)^2 = a");
    check_equal<S>(sqrt(S(a * a)), where_less(a, zero, S(-a), a), "sqrt(a^2) = |a|");
    check_equal<S>(sin(a) * sin(a) + cos(a) * cos(a), one, "sin^2 + cos^2 = 1");
    check_equal<S>(sin(S(a + b)), sin(a) * cos(b) + cos(a) * sin(b), "sin(a + b)");
    check_equal<S>(atan2(S(r * sin(a)), S(r * cos(a))), a, "atan2(r sin a, r cos a) = a");
    check_equal<S>(where_less(a, b, a, b) + where_less(a, b, b, a), a + b, "where_less takes one or the other");
    check_equal<S>(where_less(a, a, b, c), c, "where_less of equals is the second");
  }
}

}  // namespace laws
