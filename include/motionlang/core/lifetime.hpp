// SPDX-License-Identifier: MIT
/// Protection against memory that is used after it was freed: a mark for compilers, and marks of free memory for the
/// address sanitizer.
#pragma once

#include <cstddef>  // sizes

#include <motionlang/version.hpp>

/// Marks a member function or a parameter to which the result refers. Clang warns if that is a temporary, or a local
/// variable of a function that returns the result. GCC has no such mark.
#if defined(__has_cpp_attribute)
#if __has_cpp_attribute(clang::lifetimebound)
#define MOTIONLANG_LIFETIMEBOUND [[clang::lifetimebound]]
#endif
#endif
#ifndef MOTIONLANG_LIFETIMEBOUND
#define MOTIONLANG_LIFETIMEBOUND
#endif

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// True if this unit is compiled for the address sanitizer (-fsanitize=address).
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool address_sanitizer = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool address_sanitizer = true;
#else
inline constexpr bool address_sanitizer = false;
#endif
#else
inline constexpr bool address_sanitizer = false;
#endif

/// Forbids the use of memory until allow_access. The sanitizer reports every use. Without the sanitizer these calls do
/// nothing.
void forbid_access(const void* memory, std::size_t bytes);
void allow_access(const void* memory, std::size_t bytes);

}  // namespace detail
MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/lifetime.ipp>
#endif
