// SPDX-License-Identifier: MIT
/// Numbers of several lanes back into rows, one for each lane.
#pragma once

#include <cstring>  // memcpy
#include <span>     // numbers

#include <motionlang/core/lane.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// Number k of lane i goes to to[i * width + k], width = numbers.size(), for the first `count` lanes. Whole lanes of float go in
/// blocks of four by four.
template <Scalar S>
void store_rows(std::span<const Lane<S>> numbers, int count, S* to) {
  const std::size_t width = numbers.size();
  std::size_t first = 0;
  if constexpr (sizeof(S) == 4) {
    typedef S Four __attribute__((vector_size(16)));
    constexpr std::size_t bytes = sizeof(Four);
    for (; first + 4 <= width && count == Lane<S>::size; first += 4) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(Lane<S>::size); i += 4) {
        Four in[4];
        for (std::size_t k = 0; k < 4; ++k) {
          std::memcpy(&in[k], reinterpret_cast<const char*>(&numbers[first + k].v) + i * sizeof(S), bytes);
        }
        const Four low_a = __builtin_shufflevector(in[0], in[1], 0, 4, 1, 5),
                   low_b = __builtin_shufflevector(in[2], in[3], 0, 4, 1, 5),
                   high_a = __builtin_shufflevector(in[0], in[1], 2, 6, 3, 7),
                   high_b = __builtin_shufflevector(in[2], in[3], 2, 6, 3, 7);
        const Four out[4] = {
            __builtin_shufflevector(low_a, low_b, 0, 1, 4, 5), __builtin_shufflevector(low_a, low_b, 2, 3, 6, 7),
            __builtin_shufflevector(high_a, high_b, 0, 1, 4, 5), __builtin_shufflevector(high_a, high_b, 2, 3, 6, 7)};
        for (std::size_t k = 0; k < 4; ++k) std::memcpy(to + (i + k) * width + first, &out[k], bytes);
      }
    }
  }
  for (int i = 0; i < count; ++i) {
    for (std::size_t k = first; k < width; ++k) to[static_cast<std::size_t>(i) * width + k] = numbers[k][i];
  }
}

}  // namespace motionlang::inline MOTIONLANG_ABI
