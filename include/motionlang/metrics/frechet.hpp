// SPDX-License-Identifier: MIT
/// Fréchet distance of two sets of vectors, each modelled as a normal distribution: the FID of ACTOR, Guo et al. and
/// STMC.
///
///     FID = |m1 - m2|^2 + tr C1 + tr C2 - 2 tr (C1 C2)^(1/2)
///     tr (C1 C2)^(1/2) = sum_i sqrt(max(0, lambda_i)),   lambda = eigenvalues of F C2 F^T,   C1 = F^T F
/// Source  Heusel et al., "GANs trained by a two time-scale update rule ..." (NeurIPS 2017), equation 6; references:
///         ACTOR src/evaluate/action2motion/fid.py, text-to-motion utils/metrics.py, STMC mtt/metrics.py;
///         thesis 3.3.1 and 6.3.2; TM2T (ECCV 2022), appendix C
/// Units   none: that of the features, squared
/// Differs from the code, which takes a general matrix square root, drops its imaginary part, and adds 1e-6 to the
/// diagonals if that fails. The symmetric form needs no such repair, even with fewer samples than features. Both agree
/// to about 1e-6 (1e-3 in STMC, whose reference has rank 59 of 256)
#pragma once

#include <motionlang/metrics/rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Mean (d) and covariance (d, d), divided by n - 1.
struct GaussianStatistics {
  std::vector<double> mean, covariance;
  Index width() const { return std::ssize(mean); }
};

/// Throws numeric_error 302 for fewer than two rows.
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

/// Rows divided by their length, for STMC's FID+. A row of zeros stays.
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
double frechet_distance(const GaussianStatistics& a, const GaussianStatistics& b);
template <Scalar S, Scalar T>
double frechet_distance(const Rows<S>& a, const Rows<T>& b) {
  detail::require_same_width("frechet_distance", a, b);
  return frechet_distance(gaussian_statistics(a), gaussian_statistics(b));
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/frechet.ipp>
#endif
