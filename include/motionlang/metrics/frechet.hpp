// SPDX-License-Identifier: MIT
/// Fréchet distance of two sets of vectors, each taken for a normal distribution: the FID of ACTOR, Guo et al. and
/// STMC.
///
///     FID = |m1 - m2|^2 + tr C1 + tr C2 - 2 tr (C1 C2)^(1/2)
///     tr (C1 C2)^(1/2) = sum_i sqrt(max(0, lambda_i)),   lambda = eigenvalues of F C2 F^T,   C1 = F^T F
/// Source  Heusel et al., "GANs trained by a two time-scale update rule ..." (NeurIPS 2017), equation 6; references:
///         ACTOR src/evaluate/action2motion/fid.py, text-to-motion utils/metrics.py, STMC mtt/metrics.py; specs
///         actor.md 7.4, evaluation-guo.md 4, stmc-evaluation.md 4
/// Units   none: that of the features, squared
/// Differs from the code: it takes a general matrix square root, whose imaginary part it drops, and adds 1e-6 to the
///         diagonals if that fails. The symmetric form needs no such repair, also with fewer samples than features;
///         both agree to about 1e-6 (1e-3 in STMC, whose reference has rank 59 of 256)
#pragma once

#include <motionlang/metrics/detail/symmetric.hpp>
#include <motionlang/metrics/rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Mean (d) and covariance (d, d), divided by n - 1.
struct GaussianStatistics {
  std::vector<double> mean, covariance;
  Index width() const { return std::ssize(mean); }
};

/// Throws numeric_error 302 of fewer than two rows.
template <Scalar S>
GaussianStatistics gaussian_statistics(const Rows<S>& rows) {
  if (rows.size() < 2) raise<numeric_error>(302, "gaussian_statistics: a covariance of ", rows.size(), " rows");
  const auto d = static_cast<std::size_t>(rows.width());
  const auto n = static_cast<double>(rows.size());
  GaussianStatistics out{std::vector<double>(d), std::vector<double>(d * d)};
  for (Index i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < d; ++j) out.mean[j] += static_cast<double>(rows[i][j]) / n;
  }
  std::vector<double> x(d);
  for (Index i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < d; ++j) x[j] = static_cast<double>(rows[i][j]) - out.mean[j];
    for (std::size_t j = 0; j < d; ++j) {
      for (std::size_t k = j; k < d; ++k) out.covariance[j * d + k] += x[j] * x[k];
    }
  }
  for (std::size_t j = 0; j < d; ++j) {
    for (std::size_t k = j; k < d; ++k)
      out.covariance[k * d + j] = out.covariance[j * d + k] = out.covariance[j * d + k] / (n - 1);
  }
  return out;
}

/// Rows divided by their length, as STMC's FID+ has them; a row of zeros stays.
template <Scalar S>
std::vector<double> unit_rows(const Rows<S>& rows) {
  const auto lengths = detail::lengths_of_rows(rows, 1e-12);
  std::vector<double> out;
  for (Index i = 0; i < rows.size(); ++i) {
    for (const S x : rows[i]) out.push_back(static_cast<double>(x) / lengths[static_cast<std::size_t>(i)]);
  }
  return out;
}

/// Throws shape_error 204, 205; numeric_error 301
inline double frechet_distance(const GaussianStatistics& a, const GaussianStatistics& b) {
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
template <Scalar S, Scalar T>
double frechet_distance(const Rows<S>& a, const Rows<T>& b) {
  detail::require_same_width("frechet_distance", a, b);
  return frechet_distance(gaussian_statistics(a), gaussian_statistics(b));
}

MOTIONLANG_NAMESPACE_END
