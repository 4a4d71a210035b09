// Fréchet distances with a closed form, and the decompositions behind them.
#include <algorithm>
#include <limits>
#include <random>

#include <motionlang/metrics/detail/symmetric.hpp>
#include <motionlang/metrics/frechet.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using doctest::Approx;

namespace {

std::vector<double> normal_numbers(std::size_t count, unsigned seed) {
  std::mt19937 words(seed);
  std::normal_distribution<double> normal;
  std::vector<double> out(count);
  for (double& x : out) x = normal(words);
  return out;
}

}  // namespace

TEST_CASE("symmetric_eigenvalues: of matrices with known ones") {
  auto sorted = [](std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v;
  };
  // The chain -1, 2, -1 of n has the eigenvalues 2 - 2 cos(k pi / (n + 1)).
  for (const std::size_t n : {1u, 2u, 3u, 40u}) {
    std::vector<double> chain(n * n);
    for (std::size_t i = 0; i < n; ++i) {
      chain[i * n + i] = 2;
      if (i + 1 < n) chain[i * n + i + 1] = chain[(i + 1) * n + i] = -1;
    }
    const auto found = sorted(ml::detail::symmetric_eigenvalues(chain, n));
    for (std::size_t k = 0; k < n; ++k) {
      const double wanted = 2 - 2 * std::cos(static_cast<double>(k + 1) * std::acos(-1.0) / static_cast<double>(n + 1));
      CHECK(found[k] == Approx(wanted).epsilon(1e-12));
    }
  }
  // All ones: n and zeros.
  const auto ones = sorted(ml::detail::symmetric_eigenvalues(std::vector<double>(25, 1), 5));
  CHECK(ones[4] == Approx(5));
  CHECK(std::abs(ones[0]) < 1e-14);
  CHECK(ml::detail::symmetric_eigenvalues(std::vector<double>(9), 3) == std::vector<double>(3));
  CHECK_ERROR(ml::detail::symmetric_eigenvalues({std::numeric_limits<double>::infinity()}, 1),
              "[motionlang.numeric.301]");
}

TEST_CASE("semidefinite_factor: F^T F is the matrix, of its rank") {
  constexpr std::size_t n = 6;
  const auto x = normal_numbers(3 * n, 1);  // three rows: rank 3
  std::vector<double> a(n * n);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) a[i * n + j] += x[k * n + i] * x[k * n + j];
    }
  }
  const auto f = ml::detail::semidefinite_factor(a, n);
  CHECK(f.size() == 3 * n);
  for (std::size_t i = 0; i < n * n; ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += f[k * n + i / n] * f[k * n + i % n];
    CHECK(sum == Approx(a[i]).epsilon(1e-12));
  }
  CHECK(ml::detail::semidefinite_factor(std::vector<double>(4), 2).empty());
}

TEST_CASE("frechet_distance: of normal distributions along the axes") {
  // |m1 - m2|^2 + sum (s1 - s2)^2 = 25 + (2 - 1)^2 + (3 - 5)^2
  const ml::GaussianStatistics a{{0, 0}, {4, 0, 0, 9}}, b{{3, 4}, {1, 0, 0, 25}};
  CHECK(ml::frechet_distance(a, b) == Approx(30));
  CHECK(ml::frechet_distance(b, a) == Approx(30));
  // One that does not commute: C1 = diag(1, 0), C2 = ones; tr (C1 C2)^(1/2) = 1.
  const ml::GaussianStatistics flat{{0, 0}, {1, 0, 0, 0}}, diagonal{{0, 0}, {1, 1, 1, 1}};
  CHECK(ml::frechet_distance(flat, diagonal) == Approx(1));
  CHECK(ml::frechet_distance({{1}, {0}}, {{3}, {0}}) == Approx(4));
  CHECK_ERROR(ml::frechet_distance(ml::GaussianStatistics{}, {}), "[motionlang.shape.205] frechet_distance");
}

TEST_CASE("frechet_distance: identical sets, also with fewer samples than features") {
  for (const ml::Index samples : {100, 5}) {
    const auto x = normal_numbers(static_cast<std::size_t>(samples) * 12, 2);
    const ml::Rows rows(x, 12);
    CHECK(std::abs(ml::frechet_distance(rows, rows)) < 1e-6);
    auto shifted = x;
    for (double& v : shifted) v += 0.5;
    CHECK(ml::frechet_distance(rows, ml::Rows(shifted, 12)) == Approx(3));  // 12 x 0.25
  }
}

TEST_CASE("gaussian_statistics: mean and unbiased covariance") {
  const std::vector<float> x{0, 1, 2, 5};
  const auto s = ml::gaussian_statistics(ml::Rows(x, 2));
  CHECK(s.mean == std::vector<double>{1, 3});
  CHECK(s.covariance == std::vector<double>{2, 4, 4, 8});
  CHECK(ml::unit_rows(ml::Rows(std::vector<float>{3, 4, 0, 0}, 2))[1] == Approx(0.8));
}

TEST_CASE("frechet_distance: too few, different widths, NaN") {
  const std::vector<double> x{1, 2, 3, 4, 5, 6};
  CHECK_ERROR(ml::gaussian_statistics(ml::Rows(x, 6)), "[motionlang.numeric.302]");
  CHECK_ERROR(ml::frechet_distance(ml::Rows(x, 2), ml::Rows(x, 3)), "[motionlang.shape.204]");
  CHECK_ERROR(ml::frechet_distance({{1}, {1}}, {{1, 2}, {1, 0, 0, 1}}), "[motionlang.shape.204]");
  CHECK_ERROR(ml::frechet_distance({{1}, {1, 1}}, {{1}, {1}}), "[motionlang.shape.205]");
  CHECK_ERROR(ml::frechet_distance({{std::numeric_limits<double>::quiet_NaN()}, {1}}, {{1}, {1}}),
              "[motionlang.numeric.301]");
}
