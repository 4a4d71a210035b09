// SPDX-License-Identifier: MIT
/// Sorting of short lists. std::sort is faster on long ones, but every use of it is compiled with some thirty
/// functions.
#pragma once

#include <cstddef>  // size_t
#include <utility>  // swap

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// Sorts by `less`, which leaves no two elements equal or does not care for their order. Heap sort: n log n steps
/// whatever the list. `List` is a vector.
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
