// Roots of registers, over the whole range of their scalar.
#include <doctest/doctest.h>

#include <motionlang/core/lane.hpp>
#include <motionlang/core/scalar_math.hpp>

#include <cmath>
#include <limits>

namespace ml = motionlang;

TEST_CASE_TEMPLATE("roots are right to 2 units of the last place from the smallest normal number to the largest", S,
                   float, double) {
  using L = ml::Lane<S>;
  using Limits = std::numeric_limits<S>;
  double worst = 0, worst_inverse = 0;
  for (int exponent = Limits::min_exponent; exponent < Limits::max_exponent; ++exponent) {
    for (int step = 0; step < 64; ++step) {
      const S x = std::ldexp(S(1) + static_cast<S>(step) / 64, exponent - 1);
      const auto exact = std::sqrt(static_cast<long double>(x));
      const auto off = [](S got, long double want) {
        return static_cast<double>(std::abs(got / want - 1)) / static_cast<double>(Limits::epsilon());
      };
      worst = std::max(worst, off(sqrt(L(x))[L::size - 1], exact));
      worst_inverse = std::max(worst_inverse, off(inverse_sqrt(L(x))[0], 1 / exact));
    }
  }
  CHECK(worst < 2);
  CHECK(worst_inverse < 2);
  CHECK(sqrt(L(0))[0] == 0);
  CHECK(std::isfinite(inverse_sqrt(L(0))[0]));
  CHECK(std::isnan(inverse_sqrt(L(Limits::quiet_NaN()))[0]));
}
