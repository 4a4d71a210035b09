// SPDX-License-Identifier: MIT
// Bodies of symmetric.hpp.
#pragma once

#include <algorithm>  // max, swap
#include <cmath>      // sqrt, hypot
#include <limits>     // epsilon

#include <motionlang/core/error.hpp>
#include <motionlang/metrics/detail/symmetric.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<double> semidefinite_factor(std::vector<double> a, std::size_t n) {
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, a[i * n + i]);
  const double least = static_cast<double>(n) * std::numeric_limits<double>::epsilon() * largest;
  std::vector<double> factor;
  for (std::size_t rank = 0; rank < n; ++rank) {
    std::size_t pivot = 0;
    for (std::size_t i = 1; i < n; ++i) {
      if (a[i * n + i] > a[pivot * n + pivot]) pivot = i;
    }
    if (!(a[pivot * n + pivot] > least)) break;
    const double root = std::sqrt(a[pivot * n + pivot]);
    const std::size_t at = factor.size();
    for (std::size_t j = 0; j < n; ++j) factor.push_back(a[pivot * n + j] / root);
    const double* f = &factor[at];
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) a[i * n + j] -= f[i] * f[j];
    }
    for (std::size_t i = 0; i < n; ++i) a[pivot * n + i] = a[i * n + pivot] = 0;
  }
  return factor;
}

/// A tridiagonal matrix with the eigenvalues of A: its diagonal and the secondary diagonal.
struct Tridiagonal {
  std::vector<double> diagonal, beside;
};

/// Householder reflections I - v v^T / h from both sides, one column after the other.
inline Tridiagonal tridiagonal_form(std::vector<double> a, std::size_t n) {
  Tridiagonal out{std::vector<double>(n), std::vector<double>(n)};
  std::vector<double> v(n), w(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double* row = &a[k * n];
    out.diagonal[k] = row[k];
    if (k + 1 == n) break;
    double squares = 0;
    for (std::size_t j = k + 1; j < n; ++j) squares += row[j] * row[j];
    const double length = std::sqrt(squares), first = row[k + 1], beside = first > 0 ? -length : length;
    const double h = squares - first * beside;  // |v|^2 / 2
    out.beside[k] = beside;
    if (h == 0) continue;
    for (std::size_t j = k + 1; j < n; ++j) v[j] = row[j];
    v[k + 1] -= beside;
    double along = 0;  // v^T A v / (2 h)
    for (std::size_t i = k + 1; i < n; ++i) {
      double sum = 0;
      for (std::size_t j = k + 1; j < n; ++j) sum += a[i * n + j] * v[j];
      w[i] = sum / h;
      along += v[i] * w[i] / (2 * h);
    }
    for (std::size_t i = k + 1; i < n; ++i) w[i] -= along * v[i];
    for (std::size_t i = k + 1; i < n; ++i) {
      for (std::size_t j = k + 1; j < n; ++j) a[i * n + j] -= v[i] * w[j] + w[i] * v[j];
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<double> symmetric_eigenvalues(const std::vector<double>& a, std::size_t n) {
  for (const double x : a) {
    if (!std::isfinite(x)) raise<numeric_error>(301, "symmetric_eigenvalues: a matrix with a NaN or an infinity");
  }
  auto [d, e] = tridiagonal_form(a, n);
  constexpr double eps = std::numeric_limits<double>::epsilon();
  double size = 0;
  for (std::size_t i = 0; i < n; ++i) size = std::max(size, std::abs(d[i]) + std::abs(e[i]));
  for (std::size_t first = 0; first < n;) {
    std::size_t last = first;  // of the block that does not split
    while (last + 1 < n && std::abs(e[last]) > eps * (std::abs(d[last]) + std::abs(d[last + 1])) + eps * eps * size)
      ++last;
    if (last == first) {
      ++first;
      continue;
    }
    double g = (d[first + 1] - d[first]) / (2 * e[first]);
    g = d[last] - d[first] + e[first] / (g + std::copysign(std::hypot(g, 1.0), g));
    double sine = 1, cosine = 1, p = 0;
    bool split = false;
    for (std::size_t i = last; i-- > first && !split;) {
      const double f = sine * e[i], b = cosine * e[i], r = std::hypot(f, g);
      e[i + 1] = r;
      if (r == 0) {
        d[i + 1] -= p;
        split = true;
        continue;
      }
      sine = f / r, cosine = g / r;
      g = d[i + 1] - p;
      const double t = (d[i] - g) * sine + 2 * cosine * b;
      p = sine * t;
      d[i + 1] = g + p;
      g = cosine * t - b;
    }
    if (!split) d[first] -= p, e[first] = g;
    e[last] = 0;
  }
  return d;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
