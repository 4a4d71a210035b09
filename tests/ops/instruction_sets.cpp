// The kernels of every instruction set that this machine has, not only of the one that would be chosen: the same
// numbers as the reference, and the same bits whatever the batch and the number of threads.
#include <motionlang/backend/eigen.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "../laws/backend_laws.hpp"
#include "../support/kernel_sets.hpp"
#include "../support/tensors.hpp"
#include "checks.hpp"

namespace ml = motionlang;
using ml::Index;

namespace {

template <class S>
void check_every_kernel(double tolerance) {
  kernel_sets::with_every_kernel<S>([&] {
    table::check_parity<ml::EigenBackend<S>>(tolerance);
    table::check_not_a_number<ml::EigenBackend<S>>();
    table::check_far_numbers<ml::EigenBackend<S>>(tolerance);
    laws::batch_laws<ml::EigenBackend<S>>();
  });
}

/// Preparing a weight finds the one number that is not finite, wherever it stands, and takes no other for it.
template <class S>
void check_prepare_looks() {
  constexpr S largest = std::numeric_limits<S>::max(), infinity = std::numeric_limits<S>::infinity();
  const auto finite = [](const std::vector<S>& numbers, Index n, Index k) {
    return ml::EigenBackend<S>::prepare(ml::Dense<S>::from_span(numbers, ml::Shape{n, k}));
  };
  for (const auto& [n, k] : {std::pair<Index, Index>{1, 1}, {1, 40}, {40, 1}, {33, 17}, {70, 300}, {2200, 64}}) {
    std::vector<S> numbers(static_cast<std::size_t>(n * k), largest);
    numbers.back() = -largest;
    REQUIRE(finite(numbers, n, k));
    std::set<std::size_t> places{0, numbers.size() - 1, numbers.size() / 2};
    for (std::size_t i = 0; i < numbers.size(); i += numbers.size() / 20 + 1) places.insert(i);
    for (const std::size_t place : places) {
      for (const S odd : {infinity, -infinity, std::numeric_limits<S>::quiet_NaN()}) {
        CAPTURE(place);
        const S before = std::exchange(numbers[place], odd);
        REQUIRE(!finite(numbers, n, k));
        numbers[place] = before;
      }
    }
  }
}

/// gelu on a fine grid (with all odd multiples of 1/8, where polynomials meet, and their neighbours) and beyond it,
/// against the definition in double: wrong by `bound` of x at most, below 0 by `absolute_bound`, and 0 at 0.
template <class S>
void check_gelu(double bound, double absolute_bound) {
  std::vector<S> x{S(0), S(1e-30), S(-1e-30), S(50), S(-50)};
  for (int i = -9 * 2048; i <= 9 * 2048; ++i) {
    const S v = static_cast<S>(i) / S(2048);
    x.push_back(v);
    if (i != 0) x.insert(x.end(), {std::nextafter(v, S(10)), std::nextafter(v, S(-10))});
  }
  const auto y = ml::activate(ml::Tensor<ml::EigenBackend<S>, 1>::from(x, {std::ssize(x)}), ml::Activation::gelu);
  double worst = 0, worst_below = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double v = static_cast<double>(x[i]);
    const double error = std::abs(static_cast<double>(y.span()[i]) - 0.5 * v * std::erfc(-v * std::sqrt(0.5)));
    if (v == 0)
      CHECK(error == 0);
    else
      worst = std::max(worst, error / std::abs(v));
    if (v < 0) worst_below = std::max(worst_below, error);
  }
  CHECK(worst < bound);
  CHECK(worst_below < absolute_bound);
}

/// Layer norm and its derivative of some rows: the bits of every row alone.
template <class S>
void check_rows_alone(Index width) {
  constexpr Index rows = 11;
  const auto numbers = [](Index count, std::uint64_t seed) {
    return tensors::normal<ml::EigenBackend<S>, 1>({count}, seed);
  };
  const auto x = numbers(rows * width, 1), residual = numbers(rows * width, 2), dy = numbers(rows * width, 3);
  const auto weight = numbers(width, 4), bias = numbers(width, 5);
  const auto size = static_cast<std::size_t>(rows * width);
  std::vector<S> y(size), dx(size), moments(2 * rows), y_alone(size), dx_alone(size), moments_alone(2 * rows);
  const auto norm = [&](std::vector<S>& to, const S* added) {
    return ml::detail::LayerNorm<S>{.x = x.span().data(),
                                    .residual = added,
                                    .weight = weight.span().data(),
                                    .bias = bias.span().data(),
                                    .width = width,
                                    .y = to.data()};
  };
  const auto& kernels = ml::detail::kernels<S>();
  const auto& gradients = ml::detail::gradient_kernels_of(kernels);
  for (const S* added : {static_cast<const S*>(nullptr), residual.span().data()}) {
    const auto together = norm(y, added), alone = norm(y_alone, added);
    kernels.layer_norm_rows(together, 0, rows);
    gradients.layer_norm_rows(together, dy.span().data(), dx.data(), moments.data(), 0, rows);
    for (Index r = 0; r < rows; ++r) {
      kernels.layer_norm_rows(alone, r, r + 1);
      gradients.layer_norm_rows(alone, dy.span().data(), dx_alone.data(), moments_alone.data(), r, r + 1);
    }
    CHECK(y == y_alone);
    CHECK(dx == dx_alone);
    CHECK(moments == moments_alone);
  }
}

}  // namespace

TEST_CASE("gelu is as exact as its documentation says, for all kernels") {
  kernel_sets::with_every_kernel<float>([] {
    const bool looks_up = ml::detail::kernels<float>().panel_width == 32;  // 64 bytes
    check_gelu<float>(3e-7, looks_up ? 1e-7 : 2e-6);
  });
  kernel_sets::with_every_kernel<double>([] { check_gelu<double>(1e-15, 1e-15); });
}

TEST_CASE("layer norm: the same bits for a row alone and among others, for all kernels") {
  for (const Index width : {1, 15, 16, 33, 512}) {
    CAPTURE(width);
    kernel_sets::with_every_kernel<float>([&] { check_rows_alone<float>(width); });
    kernel_sets::with_every_kernel<double>([&] { check_rows_alone<double>(width); });
  }
}

TEST_CASE("preparing a weight says whether its numbers are finite, for all kernels") {
  kernel_sets::with_every_kernel<float>([] { check_prepare_looks<float>(); });
  kernel_sets::with_every_kernel<double>([] { check_prepare_looks<double>(); });
  kernel_sets::with_every_bf16_kernel([] { check_prepare_looks<float>(); });
}

TEST_CASE("portable, AVX2 and AVX-512 kernels agree with the reference") {
  check_every_kernel<float>(3e-5);
  check_every_kernel<double>(1e-13);
}
