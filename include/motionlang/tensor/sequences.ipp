// SPDX-License-Identifier: MIT
// Bodies of sequences.hpp.
#pragma once

#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY PoolVector<Index> sequence_of_row(const Offsets& offsets) {
  PoolVector<Index> owner;
  owner.reserve(static_cast<std::size_t>(offsets.rows()));
  for (Index s = 0; s < offsets.count(); ++s) {
    for (Index i = 0; i < offsets.length(s); ++i) owner.push_back(s);
  }
  return owner;
}

namespace detail {

MOTIONLANG_BODY Offsets some_sequences(const Offsets& offsets, std::span<const Index> which) {
  PoolVector<Index> lengths;
  for (Index s : which) lengths.push_back(offsets.length(s));
  return Offsets(std::span<const Index>(lengths));
}

MOTIONLANG_BODY PoolVector<Index> repeated_numbers(Index sequences, const Offsets& times) {
  if (times.count() != sequences)
    raise<shape_error>(204, "repeat_lengths: ", times.count(), " numbers of times for ", sequences, " sequences");
  return sequence_of_row(times);
}

MOTIONLANG_BODY PickedRows joined_sequences(std::span<const Offsets* const> parts) {
  const Index count = parts.front()->count();
  for (const Offsets* part : parts) {
    if (part->count() != count) raise<shape_error>(204, "concat_tokens: ", count, " sequences and ", part->count());
  }
  PoolVector<Index> pick, lengths;
  for (Index s = 0; s < count; ++s) {
    Index start = 0, length = 0;  // of the part among all rows; of the joined sequence
    for (const Offsets* part : parts) {
      for (Index r = part->begin(s); r < part->end(s); ++r) pick.push_back(start + r);
      start += part->rows();
      length += part->length(s);
    }
    lengths.push_back(length);
  }
  return {std::move(pick), Offsets(std::span<const Index>(lengths))};
}

MOTIONLANG_BODY PoolVector<Index> last_rows_of(const Offsets& offsets, const Offsets& tail) {
  if (tail.count() != offsets.count())
    raise<shape_error>(204, "last_rows: ", offsets.count(), " sequences and ", tail.count());
  PoolVector<Index> pick;
  for (Index s = 0; s < offsets.count(); ++s) {
    if (tail.length(s) > offsets.length(s)) {
      raise<shape_error>(207, "last_rows: ", tail.length(s), " of ", offsets.length(s), " rows of sequence ", s);
    }
    for (Index r = offsets.end(s) - tail.length(s); r < offsets.end(s); ++r) pick.push_back(r);
  }
  return pick;
}

MOTIONLANG_BODY PickedRows valid_rows(const Shape& shape, std::span<const unsigned char> mask) {
  const Index batch = shape[0], time = shape[1];
  if (static_cast<Index>(mask.size()) != batch * time) {
    raise<shape_error>(205, "from_padded: ", Index(mask.size()), " mask values for shape ", shape);
  }
  PoolVector<Index> rows, lengths;
  for (Index b = 0; b < batch; ++b) {
    const auto before = static_cast<Index>(rows.size());
    for (Index t = 0; t < time; ++t) {
      if (mask[static_cast<std::size_t>(b * time + t)] != 0) rows.push_back(b * time + t);
    }
    lengths.push_back(static_cast<Index>(rows.size()) - before);
  }
  return {std::move(rows), Offsets(std::span<const Index>(lengths))};
}

MOTIONLANG_BODY std::vector<unsigned char> mask_of_lengths(const Shape& shape, std::span<const Index> lengths) {
  std::vector<unsigned char> mask(static_cast<std::size_t>(shape[0] * shape[1]));
  if (static_cast<Index>(lengths.size()) != shape[0]) {
    raise<shape_error>(204, "from_padded: ", Index(lengths.size()), " lengths for shape ", shape);
  }
  for (Index b = 0; b < shape[0]; ++b) {
    const Index length = lengths[static_cast<std::size_t>(b)];
    if (length < 0 || length > shape[1]) {
      raise<shape_error>(205, "from_padded: length ", length, " of sequence ", b, " for shape ", shape);
    }
    for (Index t = 0; t < length; ++t) mask[static_cast<std::size_t>(b * shape[1] + t)] = 1;
  }
  return mask;
}

}  // namespace detail

MOTIONLANG_BODY Offsets repeat_lengths(const Offsets& offsets, const Offsets& times) {
  return detail::some_sequences(offsets, detail::repeated_numbers(offsets.count(), times));
}

MOTIONLANG_BODY std::vector<unsigned char> lengths_to_mask(std::span<const Index> lengths) {
  Index longest = 0;
  for (Index n : lengths) longest = n > longest ? n : longest;
  std::vector<unsigned char> mask;
  for (Index n : lengths) {
    for (Index i = 0; i < longest; ++i) mask.push_back(i < n ? 1 : 0);
  }
  return mask;
}

MOTIONLANG_NAMESPACE_END
