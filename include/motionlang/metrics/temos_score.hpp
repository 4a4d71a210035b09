// SPDX-License-Identifier: MIT
/// The similarity of two motions to a motion encoder: SINC's TEMOS score.
///
/// Source  thesis B.3.1; SINC (Athanasiou et al., ICCV 2023) sample_eval_latent.py
#pragma once

#include <motionlang/metrics/rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// d_i = 2 (1 - cos(g_i, r_i)): the squared distance of the unit vectors, 0 to 4.
/// generated, reference  (items, latent): means of a TEMOS model that was trained on single actions. Features of both
///                       are canonicalised; lengths may differ
/// Throws                shape_error 204
template <Scalar S, Scalar T>
std::vector<double> temos_distances(const Rows<S>& generated, const Rows<T>& reference) {
  detail::require_same_width("temos_distances", generated, reference);
  detail::require_same_count("temos_distances: generated against reference", generated.size(), reference.size());
  std::vector<double> out;
  for (Index i = 0; i < generated.size(); ++i)
    out.push_back(2 * (1 - cosine_similarities(generated.slice(i, 1), reference.slice(i, 1), 1e-8).front()));
  return out;
}

/// 1 - mean d / 4, the mean of (1 + cos) / 2: from 0 to 1. Throws shape_error 204, and numeric_error 302 without items.
template <Scalar S, Scalar T>
double temos_score(const Rows<S>& generated, const Rows<T>& reference) {
  const auto distances = temos_distances(generated, reference);
  if (distances.empty()) raise<numeric_error>(302, "temos_score: no items");
  double sum = 0;
  for (const double d : distances) sum += d;
  return 1 - sum / static_cast<double>(distances.size()) / 4;
}

MOTIONLANG_NAMESPACE_END
