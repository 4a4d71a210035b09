// SPDX-License-Identifier: MIT
// Bodies of frechet.hpp.
#pragma once

#include <motionlang/metrics/detail/symmetric.hpp>
#include <motionlang/metrics/frechet.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY double frechet_distance(const GaussianStatistics& a, const GaussianStatistics& b) {
  const auto d = static_cast<std::size_t>(a.width());
  detail::require_same_count("frechet_distance: features", a.width(), b.width());
  for (const GaussianStatistics* s : {&a, &b}) {
    if (s->covariance.size() != d * d)
      raise<shape_error>(205, "frechet_distance: a covariance of ", s->covariance.size(), " numbers for ", d,
                         " features");
  }
  if (d == 0) raise<shape_error>(205, "frechet_distance: statistics of no features");
  double out = 0;
  for (std::size_t i = 0; i < d; ++i) {
    out += (a.mean[i] - b.mean[i]) * (a.mean[i] - b.mean[i]) + a.covariance[i * d + i] + b.covariance[i * d + i];
  }
  if (!std::isfinite(out)) raise<numeric_error>(301, "frechet_distance: statistics with a NaN or an infinity");

  const std::vector<double> factor = detail::semidefinite_factor(a.covariance, d);  // (rank, d)
  const std::size_t rank = factor.size() / d;
  std::vector<double> turned(rank * d), product(rank * rank);
  for (std::size_t i = 0; i < rank; ++i) {
    for (std::size_t k = 0; k < d; ++k) {
      const double f = factor[i * d + k];
      for (std::size_t j = 0; j < d; ++j) turned[i * d + j] += f * b.covariance[k * d + j];
    }
  }
  for (std::size_t i = 0; i < rank; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = 0;
      for (std::size_t k = 0; k < d; ++k) sum += turned[i * d + k] * factor[j * d + k];
      product[i * rank + j] = product[j * rank + i] = sum;
    }
  }
  for (const double lambda : detail::symmetric_eigenvalues(product, rank)) out -= 2 * std::sqrt(std::max(0.0, lambda));
  return out;
}

MOTIONLANG_NAMESPACE_END
