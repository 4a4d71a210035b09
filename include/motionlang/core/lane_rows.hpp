// SPDX-License-Identifier: MIT
/// Rows of numbers into lanes, number k of row i in lane i of number k, and back.
#pragma once

#include <algorithm>  // min
#include <cstring>    // memcpy
#include <span>       // numbers

#include <motionlang/core/lane.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

/// Four numbers of four rows: in[i][k] becomes in[k][i].
struct FourByFour {
  typedef float Four __attribute__((vector_size(16)));
  Four in[4];

  void transpose() {
    const Four low_a = __builtin_shufflevector(in[0], in[1], 0, 4, 1, 5), low_b = __builtin_shufflevector(in[2], in[3], 0, 4, 1, 5),
               high_a = __builtin_shufflevector(in[0], in[1], 2, 6, 3, 7), high_b = __builtin_shufflevector(in[2], in[3], 2, 6, 3, 7);
    in[0] = __builtin_shufflevector(low_a, low_b, 0, 1, 4, 5), in[1] = __builtin_shufflevector(low_a, low_b, 2, 3, 6, 7);
    in[2] = __builtin_shufflevector(high_a, high_b, 0, 1, 4, 5), in[3] = __builtin_shufflevector(high_a, high_b, 2, 3, 6, 7);
  }
};

/// Calls move(i, k) for the first lane and the first number of every block of four by four, and returns how many numbers are in
/// blocks: only whole lanes of float are.
template <class L, class F>
std::size_t for_blocks_of_four(std::size_t width, int count, F move) {
  if (sizeof(L) != 4 * L::size || count != L::size) return 0;
  const std::size_t whole = width / 4 * 4;
  for (std::size_t k = 0; k < whole; k += 4) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); i += 4) move(i, k);
  }
  return whole;
}

}  // namespace detail

/// Lane i of number k is from[i * width + k], width = numbers.size(), for the first `count` lanes (at least one); further lanes are as
/// the last of these.
template <Scalar S, int bytes>
void load_rows(const S* from, int count, std::span<Lane<S, bytes>> numbers) {
  const std::size_t width = numbers.size();
  const std::size_t first = detail::for_blocks_of_four<Lane<S, bytes>>(width, count, [&](std::size_t i, std::size_t k) {
    detail::FourByFour block;
    for (std::size_t r = 0; r < 4; ++r) std::memcpy(&block.in[r], from + (i + r) * width + k, 16);
    block.transpose();
    for (std::size_t r = 0; r < 4; ++r) std::memcpy(reinterpret_cast<S*>(&numbers[k + r].v) + i, &block.in[r], 16);
  });
  for (int i = 0; i < Lane<S, bytes>::size; ++i) {
    const S* const row = from + static_cast<std::size_t>(std::min(i, count - 1)) * width;
    for (std::size_t k = first; k < width; ++k) numbers[k][i] = row[k];
  }
}

/// Number k of lane i goes to to[i * width + k], width = numbers.size(), for the first `count` lanes.
template <Scalar S, int bytes>
void store_rows(std::span<const Lane<S, bytes>> numbers, int count, S* to) {
  const std::size_t width = numbers.size();
  const std::size_t first = detail::for_blocks_of_four<Lane<S, bytes>>(width, count, [&](std::size_t i, std::size_t k) {
    detail::FourByFour block;
    for (std::size_t r = 0; r < 4; ++r) std::memcpy(&block.in[r], reinterpret_cast<const S*>(&numbers[k + r].v) + i, 16);
    block.transpose();
    for (std::size_t r = 0; r < 4; ++r) std::memcpy(to + (i + r) * width + k, &block.in[r], 16);
  });
  for (int i = 0; i < count; ++i) {
    for (std::size_t k = first; k < width; ++k) to[static_cast<std::size_t>(i) * width + k] = numbers[k][i];
  }
}

}  // namespace motionlang::inline MOTIONLANG_ABI
