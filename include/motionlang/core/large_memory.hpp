// SPDX-License-Identifier: MIT
/// Memory for weights and tables, which are read from end to end again and again. It has pages of 2 MB where the system
/// has them (Linux). At the border of small pages the processor stops reading ahead, so a scan over large ones is up to
/// 1.8 times as fast. The memory comes from the system and returns to it. A heap that mixes alignments of 2 MB with
/// small objects would keep gaps of a quarter of the weights.
#pragma once

#include <cstddef>  // sizes
#include <memory>   // shared_ptr

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The largest small page size of Linux. Addresses that are not used cost nothing.
inline constexpr std::size_t small_page = 65536, large_page = std::size_t{2} << 20;

constexpr std::size_t rounded_up(std::size_t bytes, std::size_t unit) { return (bytes + unit - 1) / unit * unit; }

}  // namespace detail

/// `bytes` bytes at a multiple of 64, not initialised. The first `used` of them will be written, mostly in large pages.
void* take_memory(std::size_t bytes, std::size_t used);

/// Returns the memory of take_memory(bytes, ...).
void give_memory(void* memory, std::size_t bytes) noexcept;

/// Room for `count` values, not initialised.
template <class T>
std::shared_ptr<T[]> large_table(std::size_t count) {
  const std::size_t bytes = count * sizeof(T);
  return {static_cast<T*>(take_memory(bytes, bytes)), [bytes](T* p) { give_memory(p, bytes); }};
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/large_memory.ipp>
#endif
