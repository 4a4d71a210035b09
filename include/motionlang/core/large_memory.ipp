// SPDX-License-Identifier: MIT
// Bodies of large_memory.hpp.
#pragma once

#include <cstdlib>  // aligned_alloc
#if defined(__linux__)
#include <sys/mman.h>  // mmap, madvise
#include <cstdint>     // addresses
#elif defined(_WIN32)
#include <malloc.h>  // _aligned_malloc
#endif

#include <motionlang/core/error.hpp>
#include <motionlang/core/large_memory.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void* take_memory(std::size_t bytes, [[maybe_unused]] std::size_t used) {
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

MOTIONLANG_BODY void give_memory(void* memory, [[maybe_unused]] std::size_t bytes) noexcept {
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

MOTIONLANG_NAMESPACE_END
