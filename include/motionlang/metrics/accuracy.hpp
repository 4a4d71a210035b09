// SPDX-License-Identifier: MIT
/// How often a classifier names the action of a motion, as ACTOR reports it.
///
/// Source  ACTOR src/evaluate/action2motion/accuracy.py; spec actor.md 7.4
#pragma once

#include <motionlang/metrics/rows.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// Counts (classes, classes): rows are labels, columns predictions, the largest logit (of equals the first).
/// logits  (samples, classes)
/// Throws  shape_error 204, 203 for a label that is no class
template <Scalar S>
std::vector<Index> confusion_matrix(const Rows<S>& logits, std::span<const Index> labels) {
  detail::require_same_count("confusion_matrix: samples against labels", logits.size(), std::ssize(labels));
  const Index classes = logits.width();
  std::vector<Index> out(static_cast<std::size_t>(classes * classes), 0);
  for (Index i = 0; i < logits.size(); ++i) {
    const Index y = labels[static_cast<std::size_t>(i)];
    if (y < 0 || y >= classes) raise<shape_error>(203, "confusion_matrix: label ", y, " of ", classes);
    const auto row = logits[i];
    const Index predicted = std::max_element(row.begin(), row.end()) - row.begin();
    ++out[static_cast<std::size_t>(y * classes + predicted)];
  }
  return out;
}

/// Share of the samples on the diagonal, 0 to 1. Throws shape_error 205 unless it is a square, numeric_error 302 of no samples.
inline double accuracy(std::span<const Index> confusion) {
  const auto classes = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(confusion.size()))));
  if (classes * classes != std::ssize(confusion))
    raise<shape_error>(205, "accuracy: ", confusion.size(), " counts are no square");
  Index right = 0, all = 0;
  for (Index i = 0; i < std::ssize(confusion); ++i) {
    const Index count = confusion[static_cast<std::size_t>(i)];
    all += count, right += i % (classes + 1) == 0 ? count : 0;
  }
  if (all == 0) raise<numeric_error>(302, "accuracy: no samples");
  return static_cast<double>(right) / static_cast<double>(all);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
