// Products in bf16x3, of floats by tiles (float_tiles.inc): as exact as multiply-adds, the same bits for any number of
// threads, the same NaN and infinities. Where the processor has no such tiles there is nothing to test.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/tensor/ops.hpp>

#include <doctest/doctest.h>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "../support/kernel_sets.hpp"
#include "../support/tensors.hpp"
#include "../support/threads.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;
using Floats = ml::Dense<float>;

namespace {

Floats normal(Index rows, Index columns, std::uint64_t seed) {
  return tensors::normal<B, 2>({rows, columns}, seed).data();
}
std::vector<float> numbers(const Floats& x) { return {x.span().begin(), x.span().end()}; }

/// f() with the kernels of an instruction set.
template <class F>
auto with(ml::detail::Isa isa, F f) {
  const kernel_sets::Instead scope(ml::detail::current_kernels<float>(), ml::detail::kernels_for<float>(isa));
  const kernel_sets::InPrecision precision(ml::Precision::bf16x3);
  return f();
}
template <class F>
auto with_tiles(F f) {
  return with(ml::detail::Isa::amx, f);
}
template <class F>
auto with_multiply_adds(F f) {
  return with(ml::detail::Isa::avx512, f);
}

bool has_tiles() {
  const bool has = ml::detail::kernels_for<float>(ml::detail::Isa::amx) != nullptr;
  if (!has) MESSAGE("this processor has no AMX");
  return has;
}

/// Errors of c against doubles, over the sum of |a b|.
struct Errors {
  double largest = 0, mean_square = 0;
};
Errors errors(const Floats& c, const Floats& a, const Floats& b, bool ta, bool tb) {
  const Index m = c.shape()[0], n = c.shape()[1], k = a.shape()[ta ? 0 : 1];
  Errors e;
  for (Index i = 0; i < m; ++i) {
    for (Index j = 0; j < n; ++j) {
      double exact = 0, size = 0;
      for (Index q = 0; q < k; ++q) {
        const double product = static_cast<double>(a.span()[static_cast<std::size_t>(ta ? q * m + i : i * k + q)]) *
                               static_cast<double>(b.span()[static_cast<std::size_t>(tb ? j * k + q : q * n + j)]);
        exact += product, size += std::abs(product);
      }
      const double error = std::abs(static_cast<double>(c.span()[static_cast<std::size_t>(i * n + j)]) - exact) / size;
      e.largest = std::max(e.largest, error);
      e.mean_square += error * error / static_cast<double>(m * n);
    }
  }
  return e;
}

}  // namespace

TEST_CASE("bf16x3: every form of the product is more exact than multiply-adds") {
  if (!has_tiles()) return;
  for (const auto& size : {std::array<Index, 3>{256, 512, 128}, {270, 600, 129}, {129, 300, 1030}, {300, 140, 2080}}) {
    const Index m = size[0], n = size[1], k = size[2];
    for (bool ta : {false, true}) {
      for (bool tb : {false, true}) {
        INFO(m, " x ", k, " x ", n, ta ? ", A transposed" : "", tb ? ", B transposed" : "");
        const Floats a = ta ? normal(k, m, 1) : normal(m, k, 1), b = tb ? normal(n, k, 2) : normal(k, n, 2);
        const auto product = [&] { return B::matmul(a, b, ta, tb); };
        const Floats by_tiles = with_tiles(product), by_multiply_adds = with_multiply_adds(product);
        REQUIRE(numbers(by_tiles) != numbers(by_multiply_adds));  // they are used
        const Errors e = errors(by_tiles, a, b, ta, tb), other = errors(by_multiply_adds, a, b, ta, tb);
        CHECK(e.largest < 3e-7);
        CHECK(e.mean_square < other.mean_square);
      }
    }
  }
}

TEST_CASE("bf16x3: numbers far from 1, and of one sign") {
  if (!has_tiles()) return;
  const Index m = 130, n = 384, k = 300;
  for (const auto& scale :
       {std::array{1e-15f, 1e15f}, {1e-3f, 1e3f}, {1e15f, 1e-15f}, {1e-15f, 1e-15f}, {1e15f, 1e15f}}) {
    Floats a = normal(m, k, 3), b = normal(k, n, 4);
    for (Index i = 0; i < m * k; ++i) a.data()[i] = std::abs(a.data()[i]) * scale[0];
    for (Index i = 0; i < k * n; ++i) b.data()[i] = std::abs(b.data()[i]) * scale[1];
    const auto product = [&] { return B::matmul(a, b, false, false); };
    const Errors e = errors(with_tiles(product), a, b, false, false);
    CHECK(e.largest < 1e-6);
    CHECK(e.mean_square < errors(with_multiply_adds(product), a, b, false, false).mean_square);
  }
}

TEST_CASE(
    "bf16x3: bias, residual and nonlinearity; prepared or not, any number of threads, the same bits; a row alone "
    "as in a batch") {
  if (!has_tiles()) return;
  for (const auto& size : {std::array<Index, 2>{400, 305}, {512, 1300}}) {
    const Index m = 150, n = size[0], k = size[1];
    const Floats x = normal(m, k, 5), w = normal(n, k, 6), residual = normal(m, n, 7);
    const Floats bias = tensors::normal<B, 1>({n}, 8).data();
    const auto run = [&](const Floats& rows, const Floats& weight, const Floats* r, ml::Activation act) {
      return numbers(B::linear(rows, weight, &bias, act, r));
    };
    const auto prepared = Floats::from_span(w.span(), w.shape());
    with_tiles([&] {
      B::prepare(prepared);
      const auto expected = run(x, w, &residual, ml::Activation::none),
                 nonlinear = run(x, w, nullptr, ml::Activation::gelu);
      for (int t : {1, 2, 3, 16}) {
        const Threads set(t);
        CHECK(run(x, prepared, &residual, ml::Activation::none) == expected);
        CHECK(run(x, prepared, nullptr, ml::Activation::gelu) == nonlinear);
      }
      const Index first = 77, last = 80;
      const Floats some = residual.rows(first, last);
      const std::vector<float> there(expected.begin() + first * n, expected.begin() + last * n);
      CHECK(run(x.rows(first, last), prepared, &some, ml::Activation::none) == there);
      CHECK(run(x.rows(first, last), w, &some, ml::Activation::none) == there);
    });
    const auto all = with_tiles([&] {
      return std::array{run(x, prepared, nullptr, ml::Activation::gelu),
                        run(x, prepared, nullptr, ml::Activation::relu),
                        run(x, prepared, &residual, ml::Activation::none)};
    });
    with_multiply_adds([&] {
      const auto near = [&](const std::vector<float>& got, const std::vector<float>& want) {
        double worst = 0;
        for (std::size_t i = 0; i < got.size(); ++i)
          worst = std::max(worst, static_cast<double>(std::abs(got[i] - want[i])));
        return worst < 2e-7 * static_cast<double>(k) && worst > 0;
      };
      CHECK(near(all[0], run(x, w, nullptr, ml::Activation::gelu)));
      CHECK(near(all[1], run(x, w, nullptr, ml::Activation::relu)));
      CHECK(near(all[2], run(x, w, &residual, ml::Activation::none)));
    });
  }
}

TEST_CASE("bf16x3: a row or column that is not finite has what multiply-adds make of it, the others keep their bits") {
  if (!has_tiles()) return;
  constexpr float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const Index m = 140, n = 420, k = 1100;
  for (bool ta : {false, true}) {
    Floats a = ta ? normal(k, m, 9) : normal(m, k, 9), b = normal(k, n, 10);
    const auto product = [&] { return B::matmul(a, b, ta, false); };
    const auto sound = numbers(with_tiles(product));
    const auto place = [&](Index row, Index at) -> float& { return a.data()[ta ? at * m + row : row * k + at]; };
    place(3, 5) = infinity, place(40, 1099) = nan, place(99, 0) = std::numeric_limits<float>::max();
    b.data()[7 * n + 300] = -infinity;
    for (int t : {1, 3}) {
      const Threads set(t);
      const auto got = numbers(with_tiles(product)), want = numbers(with_multiply_adds(product));
      for (Index i = 0; i < m; ++i) {
        for (Index j = 0; j < n; ++j) {
          const auto at = static_cast<std::size_t>(i * n + j);
          if (i == 3 || i == 40 || i == 99 || j / 32 == 300 / 32) {
            REQUIRE((got[at] == want[at] || (std::isnan(got[at]) && std::isnan(want[at]))));
          } else {
            REQUIRE(got[at] == sound[at]);
          }
        }
      }
    }
  }
}
