// SPDX-License-Identifier: MIT
/// The accuracy of a classifier of actions, as in ACTOR, and of a labeller of body parts, as in SINC.
///
/// Source  thesis 3.3.1; ACTOR src/evaluate/action2motion/accuracy.py; SINC: thesis B.2.1, table B.1
#pragma once

#include <motionlang/metrics/rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Counts (classes, classes). Rows are labels, columns are predictions: the largest logit, the first among equals.
/// logits  (samples, classes)
/// Throws  shape_error 204, 203 for a label that is not a class
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

/// Share of the samples on the diagonal, 0 to 1. Throws shape_error 205 unless it is a square, and numeric_error 302
/// without samples.
inline double accuracy(std::span<const Index> confusion) {
  const auto classes = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(confusion.size()))));
  if (classes * classes != std::ssize(confusion))
    raise<shape_error>(205, "accuracy: ", confusion.size(), " counts are not a square");
  Index right = 0, all = 0;
  for (Index i = 0; i < std::ssize(confusion); ++i) {
    const Index count = confusion[static_cast<std::size_t>(i)];
    all += count, right += i % (classes + 1) == 0 ? count : 0;
  }
  if (all == 0) raise<numeric_error>(302, "accuracy: no samples");
  return static_cast<double>(right) / static_cast<double>(all);
}

/// For labels with several yes-or-no answers (body parts of actions): for each answer, the share of the items that have
/// it right, 0 to 1. SINC's figure is their mean.
/// predicted  (items, answers), 0 or 1
/// wanted     (items, answers): 0, 1, or 0.5 if both are right, which does not count
/// Throws     shape_error 204; numeric_error 302 if an answer does not count in any item, or for another value
template <Scalar S, Scalar T>
std::vector<double> answer_accuracies(const Rows<S>& predicted, const Rows<T>& wanted) {
  detail::require_same_width("answer_accuracies", predicted, wanted);
  detail::require_same_count("answer_accuracies: predicted against wanted", predicted.size(), wanted.size());
  std::vector<double> out;
  for (std::size_t k = 0; k < static_cast<std::size_t>(wanted.width()); ++k) {
    Index right = 0, all = 0;
    for (Index i = 0; i < wanted.size(); ++i) {
      const T w = wanted[i][k];
      if (w != T(0) && w != T(0.5) && w != T(1))
        raise<numeric_error>(302, "answer_accuracies: item ", i, ", answer ", k, " is ", w);
      if (w == T(0.5)) continue;
      ++all, right += static_cast<double>(predicted[i][k]) == static_cast<double>(w) ? 1 : 0;
    }
    if (all == 0) raise<numeric_error>(302, "answer_accuracies: no item for answer ", k);
    out.push_back(static_cast<double>(right) / static_cast<double>(all));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
