// SPDX-License-Identifier: MIT
/// Dual numbers: a value and its derivative along one direction. Forward-mode differentiation of everything that is
/// written over `ScalarLike`; use `Autodiff` for gradients with respect to many inputs.
///
///     f(a + b e) = f(a) + f'(a) b e,   e^2 = 0
#pragma once

#include <motionlang/core/concepts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
struct Dual {
  S value{};
  S derivative{};

  Dual() = default;
  explicit constexpr Dual(S v, S d = S(0)) : value(v), derivative(d) {}

  friend Dual operator+(Dual a, Dual b) { return Dual(a.value + b.value, a.derivative + b.derivative); }
  friend Dual operator-(Dual a, Dual b) { return Dual(a.value - b.value, a.derivative - b.derivative); }
  friend Dual operator-(Dual a) { return Dual(-a.value, -a.derivative); }
  friend Dual operator*(Dual a, Dual b) {
    return Dual(a.value * b.value, a.derivative * b.value + a.value * b.derivative);
  }
  friend Dual operator/(Dual a, Dual b) {
    const S q = a.value / b.value;
    return Dual(q, (a.derivative - q * b.derivative) / b.value);
  }
  friend Dual sqrt(Dual a) {
    const S r = std::sqrt(a.value);
    return Dual(r, a.derivative / (S(2) * r));
  }
  friend Dual sin(Dual a) { return Dual(std::sin(a.value), a.derivative * std::cos(a.value)); }
  friend Dual cos(Dual a) { return Dual(std::cos(a.value), -a.derivative * std::sin(a.value)); }
  friend Dual atan2(Dual y, Dual x) {
    const S n = x.value * x.value + y.value * y.value;
    return Dual(std::atan2(y.value, x.value), (x.value * y.derivative - y.value * x.derivative) / n);
  }
  friend Dual where_less(Dual a, Dual b, Dual x, Dual y) { return a.value < b.value ? x : y; }
};
static_assert(ScalarLike<Dual<double>>);

MOTIONLANG_NAMESPACE_END
