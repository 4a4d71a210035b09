// Products in bfloat16: what precision.hpp promises, with the kernels of every instruction set that this machine has.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/core/half.hpp>
#include <motionlang/core/precision.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/tensor/ops.hpp>

#include <doctest/doctest.h>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "../support/kernel_sets.hpp"
#include "../support/threads.hpp"

namespace ml = motionlang;
using kernel_sets::with_every_bf16_kernel;
using ml::Index;
using B = ml::EigenBackend<float>;
using Matrix = ml::Tensor<B, 2>;

namespace {

double rounded(float x) { return static_cast<double>(ml::bfloat16_to_float(ml::float_to_bfloat16(x))); }

/// Largest error of c = a b against the product of the rounded factors, over sum |a b|; and against the exact product,
/// over the bound.
template <class A, class W>
std::pair<double, double> errors(const ml::Dense<float>& c, Index m, Index n, Index k, A a, W b) {
  double of_sum = 0, of_bound = 0;
  for (Index i = 0; i < m; ++i) {
    for (Index j = 0; j < n; ++j) {
      double exact = 0, sum = 0, size = 1e-30;
      for (Index q = 0; q < k; ++q) {
        exact += static_cast<double>(a(i, q)) * static_cast<double>(b(q, j));
        sum += rounded(a(i, q)) * rounded(b(q, j));
        size += std::abs(static_cast<double>(a(i, q)) * static_cast<double>(b(q, j)));
      }
      const double got = static_cast<double>(c.data()[i * n + j]);
      of_sum = std::max(of_sum, std::abs(got - sum) / size);
      of_bound = std::max(of_bound, std::abs(got - exact) / (size * (std::exp2(-7) + std::exp2(-16) + 1e-6)));
    }
  }
  return {of_sum, of_bound};
}

}  // namespace

TEST_CASE("bf16: every form of the product keeps the promised bound, for all kernels") {
  ml::Philox rng{.seed = 3};
  with_every_bf16_kernel([&] {
    for (const auto& size :
         {std::array<Index, 3>{1, 1, 1}, {17, 33, 31}, {47, 70, 129}, {5, 64, 700}, {300, 32, 40}, {260, 10, 1300}}) {
      const Index m = size[0], n = size[1], k = size[2];
      INFO(m, " x ", n, " x ", k);
      for (bool ta : {false, true}) {
        for (bool tb : {false, true}) {
          const auto a = Matrix::randn(ta ? ml::Shape{k, m} : ml::Shape{m, k}, rng);
          const auto b = Matrix::randn(tb ? ml::Shape{n, k} : ml::Shape{k, n}, rng);
          const auto c = B::matmul(a.data(), b.data(), ta, tb);
          const auto [of_sum, of_bound] = errors(
              c, m, n, k,
              [&](Index i, Index q) { return a.span()[static_cast<std::size_t>(ta ? q * m + i : i * k + q)]; },
              [&](Index q, Index j) { return b.span()[static_cast<std::size_t>(tb ? j * k + q : q * n + j)]; });
          CHECK(of_sum < 1e-6);
          CHECK(of_bound < 1);
          CHECK(of_bound > (k > 1 ? 1e-3 : 0));  // it did round
        }
      }
    }
  });
}

TEST_CASE("bf16: prepared weights, any batch and any number of threads give the same bits") {
  ml::Philox rng{.seed = 4};
  for (const Index k : {205, 1300}) {
    const Index m = 150, n = 90;
    const auto x = Matrix::randn({m, k}, rng), w = Matrix::randn({n, k}, rng), residual = Matrix::randn({m, n}, rng);
    const auto bias = ml::Tensor<B, 1>::randn({n}, rng);
    with_every_bf16_kernel([&] {
      auto run = [&](const ml::Dense<float>& rows, const ml::Dense<float>& weight, const ml::Dense<float>& r) {
        const auto y = B::linear(rows, weight, &bias.data(), ml::Activation::none, &r);
        return std::vector<float>(y.span().begin(), y.span().end());
      };
      const auto expected = run(x.data(), w.data(), residual.data());
      const auto prepared = ml::Dense<float>::from_span(w.span(), ml::Shape{n, k});
      B::prepare(prepared);
      CHECK(run(x.data(), prepared, residual.data()) == expected);
      for (int t : {1, 3, 16}) {
        const Threads set(t);
        CHECK(run(x.data(), prepared, residual.data()) == expected);
      }
      for (Index row : {0, 77, 149}) {
        const auto one = run(x.data().rows(row, row + 1), prepared, residual.data().rows(row, row + 1));
        CHECK(std::equal(one.begin(), one.end(), expected.begin() + row * n));
      }
      // A prepared weight keeps its precision.
      const kernel_sets::InPrecision precision(ml::Precision::fp32);
      CHECK(run(x.data(), prepared, residual.data()) == expected);
      CHECK(run(x.data(), w.data(), residual.data()) != expected);
    });
  }
}

TEST_CASE("bf16: bias, residual and nonlinearity stay in float; NaN and infinity stay what they are") {
  ml::Philox rng{.seed = 5};
  const Index m = 40, n = 50, k = 64;
  const auto w = Matrix::randn({n, k}, rng), residual = Matrix::randn({m, n}, rng);
  const auto bias = ml::Tensor<B, 1>::randn({n}, rng);
  auto zero = ml::Dense<float>::full(ml::Shape{m, k}, 0);
  with_every_bf16_kernel([&] {
    const auto y = B::linear(zero, w.data(), &bias.data(), ml::Activation::none, &residual.data());
    for (Index i = 0; i < m * n; ++i) {
      REQUIRE(y.data()[i] ==
              bias.span()[static_cast<std::size_t>(i % n)] + residual.span()[static_cast<std::size_t>(i)]);
    }
    const auto relu = B::linear(zero, w.data(), &bias.data(), ml::Activation::relu, nullptr);
    for (Index i = 0; i < m * n; ++i)
      REQUIRE(relu.data()[i] == std::max(0.f, bias.span()[static_cast<std::size_t>(i % n)]));
    auto x = ml::Dense<float>::full(ml::Shape{2, k}, 1);
    x.data()[3] = std::numeric_limits<float>::quiet_NaN();
    x.data()[k + 3] = std::numeric_limits<float>::infinity();
    const auto bad = B::linear(x, w.data(), nullptr, ml::Activation::none, nullptr);
    for (Index j = 0; j < n; ++j) {
      REQUIRE(std::isnan(bad.data()[j]));
      REQUIRE(std::isinf(bad.data()[n + j]));
    }
  });
}

TEST_CASE(
    "bf16: attention over sequences of many lengths and its gradients are those of float, nearly; the same bits for "
    "each sequence alone") {
  ml::Philox rng{.seed = 6};
  const ml::Offsets offsets(std::vector<Index>{1, 47, 0, 33, 100});
  const Index heads = 3, width = 3 * 20;
  const auto q = Matrix::randn({offsets.rows(), width}, rng), k = Matrix::randn({offsets.rows(), width}, rng),
             v = Matrix::randn({offsets.rows(), width}, rng), dy = Matrix::randn({offsets.rows(), width}, rng);
  for (bool causal : {false, true}) {
    const ml::AttentionOptions in_fp32{.heads = heads, .causal = causal};
    const auto exact = B::attention(q.data(), k.data(), v.data(), offsets, offsets, in_fp32);
    const auto gradients = B::attention_vjp(q.data(), k.data(), v.data(), offsets, offsets, in_fp32, dy.data());
    with_every_bf16_kernel([&] {
      const ml::AttentionOptions options{.heads = heads, .causal = causal};  // of the process
      CHECK(options.precision == ml::Precision::bf16);
      const auto rounded_gradients =
          B::attention_vjp(q.data(), k.data(), v.data(), offsets, offsets, options, dy.data());
      for (std::size_t g = 0; g < 3; ++g) {
        double error = 0, size = 0;
        for (Index i = 0; i < gradients[g].count(); ++i) {
          const auto there = static_cast<double>(gradients[g].data()[i]);
          error += std::pow(static_cast<double>(rounded_gradients[g].data()[i]) - there, 2), size += there * there;
        }
        CHECK(std::sqrt(error / size) < 0.02);
        CHECK(std::sqrt(error / size) > 1e-5);
      }
      const auto o = B::attention(q.data(), k.data(), v.data(), offsets, offsets, options);
      double worst = 0;
      for (Index i = 0; i < o.count(); ++i)
        worst = std::max(worst, static_cast<double>(std::abs(o.data()[i] - exact.data()[i])));
      CHECK(worst < 0.05);  // scores near 4 in size are wrong by 2^-7 of their terms
      CHECK(worst > 1e-5);
      const ml::Offsets alone(std::vector<Index>{offsets.length(3)});
      const Index first = 48, last = first + 33;
      const auto one = B::attention(q.data().rows(first, last), k.data().rows(first, last), v.data().rows(first, last),
                                    alone, alone, options);
      CHECK(std::equal(one.span().begin(), one.span().end(), o.span().begin() + first * width));
      for (int threads : {1, 3, 16}) {  // queries of a head are split
        const Threads set(threads);
        const auto again = B::attention(q.data(), k.data(), v.data(), offsets, offsets, options);
        CHECK(std::equal(again.span().begin(), again.span().end(), o.span().begin()));
      }
    });
  }
}
