// SPDX-License-Identifier: MIT
/// Moves rows of values into lanes and back. Value k of row i is lane i of value k.
///
/// Floats are moved four at a time. A register consists of pieces of 16 bytes, and piece i of register r holds four
/// values of row 4 i + r. In four such registers, the four-by-four squares at the same piece are transposed.
#pragma once

#include <algorithm>  // min
#include <cstring>    // memcpy
#include <span>       // numbers
#include <utility>    // index_sequence

#include <motionlang/core/lane.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

// Inlined, like all of lane.hpp.
#define MOTIONLANG_INLINE inline __attribute__((always_inline))

/// Piece i of a register, four values, is at from + i * step.
template <int bytes>
MOTIONLANG_INLINE void load_pieces(const float* from, std::size_t step, Lane<float, bytes>& to) {
  if constexpr (bytes == 16) {
    std::memcpy(&to.v, from, 16);
  } else {
    Lane<float, bytes / 2> low, high;
    load_pieces(from, step, low);
    load_pieces(from + bytes / 32 * step, step, high);
    [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
      to.v = __builtin_shufflevector(low.v, high.v, i...);
    }
    (std::make_integer_sequence<int, bytes / 4>());
  }
}
template <int bytes>
MOTIONLANG_INLINE void store_pieces(const Lane<float, bytes>& from, float* to, std::size_t step) {
  if constexpr (bytes == 16) {
    std::memcpy(to, &from.v, 16);
  } else {
    Lane<float, bytes / 2> low, high;
    [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
      low.v = __builtin_shufflevector(from.v, from.v, i...);
      high.v = __builtin_shufflevector(from.v, from.v, (i + bytes / 8)...);
    }
    (std::make_integer_sequence<int, bytes / 8>());
    store_pieces(low, to, step);
    store_pieces(high, to + bytes / 32 * step, step);
  }
}

/// In every piece: values p and q of a, then r and t of b.
template <int p, int q, int r, int t, int bytes>
MOTIONLANG_INLINE Lane<float, bytes> mix(const Lane<float, bytes>& a, const Lane<float, bytes>& b) {
  constexpr int n = bytes / 4, from[4] = {p, q, n + r, n + t};
  Lane<float, bytes> mixed;
  [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
    mixed.v = __builtin_shufflevector(a.v, b.v, (i / 4 * 4 + from[i % 4])...);
  }
  (std::make_integer_sequence<int, n>());
  return mixed;
}

/// In every piece: value k of in[i] becomes value i of in[k].
template <int bytes>
MOTIONLANG_INLINE void transpose_pieces(Lane<float, bytes> (&in)[4]) {
  const auto low_a = mix<0, 1, 0, 1>(in[0], in[1]), high_a = mix<2, 3, 2, 3>(in[0], in[1]),
             low_b = mix<0, 1, 0, 1>(in[2], in[3]), high_b = mix<2, 3, 2, 3>(in[2], in[3]);
  in[0] = mix<0, 2, 0, 2>(low_a, low_b), in[1] = mix<1, 3, 1, 3>(low_a, low_b);
  in[2] = mix<0, 2, 0, 2>(high_a, high_b), in[3] = mix<1, 3, 1, 3>(high_a, high_b);
}

}  // namespace detail

/// Lane i of value k is from[i * step + k] for the first `count` lanes (at least one). Further lanes repeat the last of
/// these.
template <Scalar S, int bytes>
MOTIONLANG_INLINE void load_rows(const S* from, std::size_t step, int count, std::span<Lane<S, bytes>> numbers) {
  using L = Lane<S, bytes>;
  constexpr auto lanes = static_cast<std::size_t>(L::size);
  const auto last = static_cast<std::size_t>(count - 1);
  const bool whole = last + 1 == lanes;
  std::size_t k = 0;
  if constexpr (sizeof(S) == 4) {
    for (; k + 4 <= numbers.size(); k += 4) {
      L block[4];
      S copy[4 * lanes];  // where lanes are missing
      if (!whole) {
        for (std::size_t i = 0; i < lanes; ++i) std::memcpy(copy + 4 * i, from + std::min(i, last) * step + k, 16);
      }
      const S* const rows = whole ? from + k : copy;
      const std::size_t row = whole ? step : 4;
      for (std::size_t r = 0; r < 4; ++r) detail::load_pieces(rows + r * row, 4 * row, block[r]);
      detail::transpose_pieces(block);
      for (std::size_t r = 0; r < 4; ++r) numbers[k + r].v = block[r].v;
    }
  }
  for (; k < numbers.size(); ++k) {
    for (std::size_t i = 0; i < lanes; ++i) numbers[k][static_cast<int>(i)] = from[std::min(i, last) * step + k];
  }
}

/// Value k of lane i goes to to[i * step + k] for the first `count` lanes.
template <Scalar S, int bytes>
MOTIONLANG_INLINE void store_rows(std::span<const Lane<S, bytes>> numbers, std::size_t step, int count, S* to) {
  using L = Lane<S, bytes>;
  constexpr auto lanes = static_cast<std::size_t>(L::size);
  const auto used = static_cast<std::size_t>(count);
  const bool whole = used == lanes;
  std::size_t k = 0;
  if constexpr (sizeof(S) == 4) {
    for (; k + 4 <= numbers.size(); k += 4) {
      L block[4];
      S copy[4 * lanes];
      for (std::size_t r = 0; r < 4; ++r) block[r].v = numbers[k + r].v;
      detail::transpose_pieces(block);
      S* const rows = whole ? to + k : copy;
      const std::size_t row = whole ? step : 4;
      for (std::size_t r = 0; r < 4; ++r) detail::store_pieces(block[r], rows + r * row, 4 * row);
      if (!whole) {
        for (std::size_t i = 0; i < used; ++i) std::memcpy(to + i * step + k, copy + 4 * i, 16);
      }
    }
  }
  for (; k < numbers.size(); ++k) {
    for (std::size_t i = 0; i < used; ++i) to[i * step + k] = numbers[k][static_cast<int>(i)];
  }
}

#undef MOTIONLANG_INLINE

MOTIONLANG_NAMESPACE_END
