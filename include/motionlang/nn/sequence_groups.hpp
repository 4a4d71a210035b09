// SPDX-License-Identifier: MIT
/// A few sequences of a batch at a time through a whole stack of layers.
#pragma once

#include <motionlang/core/context.hpp>
#include <motionlang/tensor/sequences.hpp>

namespace motionlang::inline MOTIONLANG_ABI::detail {

/// Sequences first ... last-1.
inline Offsets some_sequences(const Offsets& offsets, Index first, Index last) {
  PoolVector<Index> lengths;
  for (Index s = first; s < last; ++s) lengths.push_back(offsets.length(s));
  return Offsets(std::span<const Index>(lengths));
}
template <Backend B>
Sequences<B> some_sequences(const Sequences<B>& x, Index first, Index last) {
  if (first == 0 && last == x.count()) return x;
  return {slice(x.rows, 0, x.offsets.begin(first), x.offsets.begin(last)), some_sequences(x.offsets, first, last)};
}

/// The rows f(first, last) of sequences first ... last-1, as many at a time as have B::rows_in_cache() rows (a longer one alone): what
/// one layer writes is still in the cache when the next reads it. f treats each sequence on its own, so the numbers are those of all at
/// once. Where the backend says nothing, gradients are kept or dropout counts rows, it is called for all at once. Weights that were not
/// prepared are packed for every group.
template <Backend B, class F>
Tensor<B, 2> in_groups(const Offsets& offsets, const Context& context, F f) {
  const Index count = offsets.count();
  if constexpr (requires { B::rows_in_cache(); }) {
    const Index at_once = B::rows_in_cache();
    if (!context.dropout && offsets.rows() > at_once) {
      PoolVector<Tensor<B, 2>> parts;
      for (Index first = 0, last = 0; first < count; first = last) {
        do ++last;
        while (last < count && offsets.end(last) - offsets.begin(first) <= at_once);
        parts.push_back(f(first, last));
      }
      return concat(std::span<const Tensor<B, 2>>(parts), 0);
    }
  }
  return f(Index{0}, count);
}
/// The same with f(some), `some` being these sequences of x.
template <Backend B, class F>
Tensor<B, 2> in_groups(const Sequences<B>& x, const Context& context, F f) {
  return in_groups<B>(x.offsets, context, [&](Index first, Index last) { return f(some_sequences(x, first, last)); });
}

}  // namespace motionlang::inline MOTIONLANG_ABI::detail
