// SPDX-License-Identifier: MIT
/// Memory for what is read from end to end again and again, weights and tables: in pages of 2 MB where the system has
/// them (Linux). Between small pages the processor stops to read ahead; a scan over large ones is up to 1.8 times as
/// fast. It comes from the system itself and goes back there: a heap that mixes alignments of 2 MB with small things
/// keeps the gaps (a quarter of the weights).
#pragma once

#include <cstddef>  // sizes
#include <cstdlib>  // aligned_alloc
#include <memory>   // shared_ptr
#if defined(__linux__)
#include <sys/mman.h>  // mmap, madvise
#include <cstdint>     // addresses
#elif defined(_WIN32)
#include <malloc.h>  // _aligned_malloc
#endif

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The largest of the small ones that Linux has: addresses of which none is used cost nothing.
inline constexpr std::size_t small_page = 65536, large_page = std::size_t{2} << 20;

constexpr std::size_t rounded_up(std::size_t bytes, std::size_t unit) { return (bytes + unit - 1) / unit * unit; }

}  // namespace detail

/// `bytes` bytes at a multiple of 64, not initialised; `used` of them from the start will be written, so many lie in
/// large pages.
inline void* take_memory(std::size_t bytes, [[maybe_unused]] std::size_t used) {
#if defined(__linux__)
  if (bytes >= detail::large_page) {
    const std::size_t whole = detail::rounded_up(bytes, detail::small_page), room = whole + detail::large_page;
    void* start = ::mmap(nullptr, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (start == MAP_FAILED) detail::raise_bad_alloc();
    const auto address = reinterpret_cast<std::uintptr_t>(start);
    const std::size_t before = detail::rounded_up(address, detail::large_page) - address, after = room - whole - before;
    std::byte* memory = static_cast<std::byte*>(start) + before;
    if (before > 0) ::munmap(start, before);
    if (after > 0) ::munmap(memory + whole, after);
    // a page that is partly used would be taken whole
    const std::size_t large = used / detail::large_page * detail::large_page;
    ::madvise(memory, large, MADV_HUGEPAGE);
    ::madvise(memory + large, whole - large, MADV_NOHUGEPAGE);  // where the system takes large pages for everything
    return memory;
  }
#endif
#if defined(_WIN32)
  void* memory = ::_aligned_malloc(bytes + 1, 64);
#else
  void* memory = std::aligned_alloc(64, detail::rounded_up(bytes + 1, 64));
#endif
  if (memory == nullptr) detail::raise_bad_alloc();
  return memory;
}

/// Gives back what take_memory(bytes, ...) gave.
inline void give_memory(void* memory, [[maybe_unused]] std::size_t bytes) noexcept {
#if defined(__linux__)
  if (bytes >= detail::large_page) {
    ::munmap(memory, detail::rounded_up(bytes, detail::small_page));
    return;
  }
#endif
#if defined(_WIN32)
  ::_aligned_free(memory);
#else
  std::free(memory);
#endif
}

/// Room for `count` numbers, not initialised.
template <class T>
std::shared_ptr<T[]> large_table(std::size_t count) {
  const std::size_t bytes = count * sizeof(T);
  return {static_cast<T*>(take_memory(bytes, bytes)), [bytes](T* p) { give_memory(p, bytes); }};
}

MOTIONLANG_NAMESPACE_END
