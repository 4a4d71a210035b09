// SPDX-License-Identifier: MIT
/// A batch of sequences without padding: the rows of all sequences in order, and the start of each.
///
/// Layers that treat rows alike (linear, norms, nonlinearities, losses) see only rows. Attention, positions and pooling
/// take the offsets. Padded tensors and masks exist only at the borders: for loaders and for comparison with other
/// programs.
#pragma once

#include <motionlang/core/offsets.hpp>
#include <motionlang/tensor/index.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct Sequences {
  Tensor<B, 2> rows;  // (sum of lengths, width)
  Offsets offsets;

  Sequences() = default;
  /// Throws shape_error 207 unless the offsets end at the last row.
  Sequences(Tensor<B, 2> r, const Offsets& o) : rows(std::move(r)), offsets(o) {
    if (rows.size(0) != offsets.rows()) {
      raise<shape_error>(207, "Sequences: offsets for ", offsets.rows(), " rows, tensor is ", rows.shape());
    }
  }
  Index count() const { return offsets.count(); }
  Index width() const { return rows.size(1); }
  /// One sequence, (length, width).
  Tensor<B, 2> operator[](Index i) const { return slice(rows, 0, offsets.begin(i), offsets.end(i)); }
  /// The same structure with other rows.
  Sequences with(Tensor<B, 2> r) const { return {std::move(r), offsets}; }
};

/// For every row the number of its sequence.
PoolVector<Index> sequence_of_row(const Offsets& offsets);
/// Repeats one row per sequence for all rows of the sequence: (sequences, width) -> (rows, width). Throws shape_error
/// 204 for another count.
template <Backend B>
Tensor<B, 2> repeat_for_rows(const Tensor<B, 2>& per_sequence, const Offsets& offsets) {
  if (per_sequence.size(0) != offsets.count())
    raise<shape_error>(204, "repeat_for_rows: ", per_sequence.size(0), " rows for ", offsets.count(), " sequences");
  return gather(per_sequence, sequence_of_row(offsets));
}
/// The same rows for each of `count` sequences.
template <Backend B>
Sequences<B> repeat_sequence(const Tensor<B, 2>& rows, Index count) {
  PoolVector<Index> pick;
  for (Index s = 0; s < count; ++s) {
    for (Index i = 0; i < rows.size(0); ++i) pick.push_back(i);
  }
  return {gather(rows, pick), Offsets::equal(count, rows.size(0))};
}

namespace detail {

/// The lengths of the sequences `which`: existing numbers in any order, with repetition.
Offsets some_sequences(const Offsets& offsets, std::span<const Index> which);
/// The sequences `which`, without copying if these are all of them in order.
template <Backend B>
Sequences<B> some_sequences(const Sequences<B>& x, std::span<const Index> which) {
  const Index first = which.empty() ? 0 : which.front(), count = std::ssize(which);
  bool in_a_row = true;
  for (Index i = 0; i < count; ++i) in_a_row = in_a_row && which[static_cast<std::size_t>(i)] == first + i;
  if (in_a_row && count == x.count()) return x;
  const Offsets offsets = some_sequences(x.offsets, which);
  if (in_a_row) return {slice(x.rows, 0, x.offsets.begin(first), x.offsets.begin(first + count)), offsets};
  PoolVector<Index> rows;
  for (Index s : which) {
    for (Index r = x.offsets.begin(s); r < x.offsets.end(s); ++r) rows.push_back(r);
  }
  return {gather(x.rows, rows), offsets};
}
/// Number i, times.length(i) times. Throws shape_error 204 for another number of times.
PoolVector<Index> repeated_numbers(Index sequences, const Offsets& times);

/// Rows to select, and the lengths of their sequences.
struct PickedRows {
  PoolVector<Index> rows;
  Offsets offsets;
};
/// For concat_tokens: the parts in order. Throws shape_error 204 if the counts differ.
PickedRows joined_sequences(std::span<const Offsets* const> parts);
/// For last_rows. Throws shape_error 204, 207.
PoolVector<Index> last_rows_of(const Offsets& offsets, const Offsets& tail);
/// For from_padded: shape (batch, time, width), mask (batch, time). Throws shape_error 205.
PickedRows valid_rows(const Shape& shape, std::span<const unsigned char> mask);
/// The same for lengths. Throws shape_error 204, 205.
std::vector<unsigned char> mask_of_lengths(const Shape& shape, std::span<const Index> lengths);

}  // namespace detail

/// Sequence i, times.length(i) times, in order. Throws shape_error 204 for another number of times.
Offsets repeat_lengths(const Offsets& offsets, const Offsets& times);
template <Backend B>
Sequences<B> repeat_sequences(const Sequences<B>& x, const Offsets& times) {
  return detail::some_sequences(x, detail::repeated_numbers(x.count(), times));
}

/// Joins sequence by sequence: the rows of a's sequence i, then of b's, ... Throws shape_error 204 if the counts
/// differ.
template <Backend B, class... T>
Sequences<B> concat_tokens(const Sequences<B>& first, const T&... more) {
  const std::array<const Offsets*, 1 + sizeof...(T)> parts{&first.offsets, &more.offsets...};
  auto joined = detail::joined_sequences(parts);
  return {gather(concat(0, first.rows, more.rows...), joined.rows), std::move(joined.offsets)};
}
/// The last tail.length(i) rows of each sequence. Throws shape_error 204, 207.
template <Backend B>
Sequences<B> last_rows(const Sequences<B>& x, const Offsets& tail) {
  return {gather(x.rows, detail::last_rows_of(x.offsets, tail)), tail};
}
/// Each sequence without its first n rows.
template <Backend B>
Sequences<B> drop_tokens(const Sequences<B>& x, Index n) {
  PoolVector<Index> lengths;
  for (Index s = 0; s < x.count(); ++s) lengths.push_back(x.offsets.length(s) - n);
  return last_rows(x, Offsets(std::span<const Index>(lengths)));
}

/// true for the first lengths[i] of `longest` frames: (sequences, longest), row-major, 1 = valid.
std::vector<unsigned char> lengths_to_mask(std::span<const Index> lengths);

/// x (batch, time, width) and mask (batch, time; 0 = padding) to the valid rows. Padding need not be at the end.
template <Backend B>
Sequences<B> from_padded(const Tensor<B, 3>& x, std::span<const unsigned char> mask) {
  auto valid = detail::valid_rows(x.shape(), mask);
  return {gather(reshape<2>(x, {x.size(0) * x.size(1), x.size(2)}), valid.rows), std::move(valid.offsets)};
}
/// The first lengths[i] frames of each. Throws shape_error 204, 205.
template <Backend B>
Sequences<B> from_padded(const Tensor<B, 3>& x, std::span<const Index> lengths) {
  return from_padded(x, std::span<const unsigned char>(detail::mask_of_lengths(x.shape(), lengths)));
}
/// All sequences of a (batch, time, width) tensor at full length.
template <Backend B>
Sequences<B> from_equal(const Tensor<B, 3>& x) {
  return {reshape<2>(x, {x.size(0) * x.size(1), x.size(2)}), Offsets::equal(x.size(0), x.size(1))};
}

/// (batch, time, width) with `value` behind the end of each sequence; `time` is the longest length when 0.
template <Backend B>
Tensor<B, 3> to_padded(const Sequences<B>& x, double value = 0, Index time = 0) {
  if (time == 0) time = x.offsets.longest();
  if (time < x.offsets.longest())
    raise<shape_error>(205, "to_padded: ", time, " frames for a sequence of ", x.offsets.longest());
  // A last row of padding, which all padded positions select.
  const auto rows = concat(0, x.rows, Tensor<B, 2>::full({1, x.width()}, value));
  std::vector<Index> pick;
  for (Index i = 0; i < x.count(); ++i) {
    for (Index t = 0; t < time; ++t)
      pick.push_back(t < x.offsets.length(i) ? x.offsets.begin(i) + t : x.offsets.rows());
  }
  return reshape<3>(gather(rows, pick), {x.count(), time, x.width()});
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/tensor/sequences.ipp>
#endif
