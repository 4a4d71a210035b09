// SPDX-License-Identifier: MIT
// Bodies of lifetime.hpp.
#pragma once

#include <motionlang/core/lifetime.hpp>

// Functions of the sanitizer.
extern "C" {
void __asan_poison_memory_region(const volatile void* memory, std::size_t bytes);    // NOLINT
void __asan_unpoison_memory_region(const volatile void* memory, std::size_t bytes);  // NOLINT
}

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

MOTIONLANG_BODY void forbid_access([[maybe_unused]] const void* memory, [[maybe_unused]] std::size_t bytes) {
  if constexpr (address_sanitizer) __asan_poison_memory_region(memory, bytes);
}

MOTIONLANG_BODY void allow_access([[maybe_unused]] const void* memory, [[maybe_unused]] std::size_t bytes) {
  if constexpr (address_sanitizer) __asan_unpoison_memory_region(memory, bytes);
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
