// SPDX-License-Identifier: MIT
/// Sorts short lists. std::sort is faster on long ones, but each use of it compiles some thirty functions.
#pragma once

#include <cstddef>  // size_t
#include <utility>  // swap

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// Sorts by `less`. The order of equal elements is not defined. Heap sort: n log n steps for any list. `List` is a
/// vector.
template <class List, class Less>
void sort(List& list, Less less) {
  const auto sift_down = [&](std::size_t i, std::size_t size) {
    for (std::size_t child; (child = 2 * i + 1) < size; i = child) {
      if (child + 1 < size && less(list[child], list[child + 1])) ++child;
      if (!less(list[i], list[child])) return;
      std::swap(list[i], list[child]);
    }
  };
  for (std::size_t i = list.size() / 2; i-- > 0;) sift_down(i, list.size());
  for (std::size_t size = list.size(); size-- > 1;) {
    std::swap(list[0], list[size]);
    sift_down(0, size);
  }
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
