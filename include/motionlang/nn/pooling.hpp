// SPDX-License-Identifier: MIT
/// From the vectors of all tokens to one vector for each text.
#pragma once

#include <motionlang/nn/text_features.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/normalize.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The mean of each sequence, (sequences, width); zeros for an empty one.
template <Backend B>
Tensor<B, 2> mean_rows(const Sequences<B>& x) {
  std::vector<typename B::scalar> share;
  for (Index i = 0; i < x.count(); ++i)
    share.push_back(static_cast<typename B::scalar>(1 / std::max(1.0, static_cast<double>(x.offsets.length(i)))));
  return scatter_add(x.rows, sequence_of_row(x.offsets), x.count()) * Tensor<B, 2>::from(share, {x.count(), 1});
}

/// One row of each sequence, `at[i]` of sequence i. Throws shape_error 203 if there is no such row, 204 if the counts
/// differ.
template <Backend B>
Tensor<B, 2> pick_rows(const Sequences<B>& x, std::span<const Index> at) {
  if (static_cast<Index>(at.size()) != x.count())
    raise<shape_error>(204, "pick_rows: ", at.size(), " places for ", x.count(), " sequences");
  PoolVector<Index> rows;
  for (Index i = 0; i < x.count(); ++i) {
    const Index row = at[static_cast<std::size_t>(i)];
    if (row < 0 || row >= x.offsets.length(i))
      raise<shape_error>(203, "pick_rows: row ", row, " of ", x.offsets.length(i), " in sequence ", i);
    rows.push_back(x.offsets.begin(i) + row);
  }
  return gather(x.rows, rows);
}

/// The last row of each sequence, (sequences, width). Throws shape_error 203 for an empty one.
template <Backend B>
Tensor<B, 2> last_row(const Sequences<B>& x) {
  PoolVector<Index> at;
  for (Index i = 0; i < x.count(); ++i) at.push_back(x.offsets.length(i) - 1);
  return pick_rows(x, at);
}

/// The pooling of a text's tokens: keep all; their mean; the first one ([CLS]); the end token, or the last token if the
/// network does not mark an end.
enum class Pooling { none, mean, first, end };

/// (texts, width). Throws config_error 101 for Pooling::none, shape_error 203 for a text without tokens.
template <Backend B>
Tensor<B, 2> pool(const TextFeatures<B>& text, Pooling pooling) {
  if (pooling == Pooling::none) raise<config_error>(101, "pool: Pooling::none has no vector for a text");
  if (pooling == Pooling::mean) return mean_rows(text.tokens);
  if (pooling == Pooling::end && !text.end_position.empty()) return pick_rows(text.tokens, text.end_position);
  if (pooling == Pooling::end) return last_row(text.tokens);
  return pick_rows(text.tokens, PoolVector<Index>(static_cast<std::size_t>(text.count()), 0));
}

MOTIONLANG_NAMESPACE_END
