// SPDX-License-Identifier: MIT
/// Little-endian numbers in byte buffers (checked reading, appending), and base64.
#pragma once

#include <bit>          // endian
#include <cstddef>      // byte
#include <cstdint>      // fixed widths
#include <cstring>      // memcpy
#include <span>         // views
#include <string>       // base64
#include <string_view>  // file names
#include <type_traits>  // is_trivially_copyable
#include <vector>       // buffers

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

static_assert(std::endian::native == std::endian::little, "the files are little-endian and are copied as they are");

template <class T>
concept Plain = std::is_trivially_copyable_v<T>;

/// The value stored at `at`. Throws io_error 402 if it is not inside. Messages contain `what` and `file`.
template <Plain T>
T load(std::span<const std::byte> bytes, std::uint64_t at, std::string_view file, std::string_view what) {
  if (at > bytes.size() || bytes.size() - at < sizeof(T)) {
    raise<io_error>(402, file, ": ends inside ", what, " at byte ", at, " (", counted(bytes.size(), "byte"), ")");
  }
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// `size` bytes from `at`. Throws io_error 402 if they are not inside.
std::span<const std::byte> slice(std::span<const std::byte> bytes, std::uint64_t at, std::uint64_t size,
                                 std::string_view file, std::string_view what);

inline void append_bytes(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  const std::size_t size = out.size();
  out.resize(size + bytes.size());
  std::memcpy(out.data() + size, bytes.data(), bytes.size());  // vector::insert makes GCC 12 warn of overflow at -O3
}
inline void append_text(std::vector<std::byte>& out, std::string_view text) {
  append_bytes(out, std::as_bytes(std::span(text.data(), text.size())));
}
template <Plain T>
void append_value(std::vector<std::byte>& out, const T& value) {
  append_bytes(out, std::as_bytes(std::span(&value, 1)));
}

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Source  RFC 4648, section 4.
std::string to_base64(std::span<const std::byte> bytes);

/// Skips white space. Messages contain `name`. Throws io_error 403 for any other character outside the alphabet.
std::vector<std::byte> from_base64(std::string_view text, std::string_view name = "text");

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/detail/bytes.ipp>
#endif
