// SPDX-License-Identifier: MIT
/// Memory for what is read from end to end again and again, tables and weights: in pages of 2 MB where the system has them (Linux).
/// Between small pages the processor stops to read ahead; a scan over large ones is up to 1.8 times as fast.
#pragma once

#include <algorithm>  // max
#include <cstddef>    // sizes
#include <cstdlib>    // aligned_alloc
#include <memory>     // shared_ptr
#include <new>        // bad_alloc
#if defined(__linux__)
#include <sys/mman.h>  // madvise
#endif

#include <motionlang/version.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// `bytes` bytes at a multiple of 64, not initialised, for std::free.
inline void* large_memory(std::size_t bytes) {
  constexpr std::size_t page = std::size_t{2} << 20;
  const std::size_t alignment = bytes < page ? 64 : page;
  void* memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
#if defined(__linux__)
  if (bytes >= page) ::madvise(memory, bytes / page * page, MADV_HUGEPAGE);  // whole pages only: the rest takes no more than it needs
#endif
  return memory;
}

/// Room for `count` numbers, not initialised.
template <class T>
std::shared_ptr<T[]> large_table(std::size_t count) {
  return {static_cast<T*>(large_memory(std::max<std::size_t>(1, count) * sizeof(T))), [](T* p) { std::free(p); }};
}

}  // namespace motionlang::inline MOTIONLANG_ABI
