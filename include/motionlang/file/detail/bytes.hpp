// SPDX-License-Identifier: MIT
/// Little-endian numbers in byte buffers: checked reading, appending. And base64.
#pragma once

#include <bit>          // bit_cast, endian
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

/// The value stored at `at`. Throws io_error 402 if it does not lie inside; `what` and `file` are for the message.
template <Plain T>
T load(std::span<const std::byte> bytes, std::uint64_t at, std::string_view file, std::string_view what) {
  if (at > bytes.size() || bytes.size() - at < sizeof(T)) {
    raise<io_error>(402, file, ": ends inside ", what, " at byte ", at, " (", counted(bytes.size(), "byte"), ")");
  }
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

/// `size` bytes from `at`. Throws io_error 402 if they do not lie inside.
inline std::span<const std::byte> slice(std::span<const std::byte> bytes, std::uint64_t at, std::uint64_t size,
                                        std::string_view file, std::string_view what) {
  if (at > bytes.size() || bytes.size() - at < size) {
    raise<io_error>(402, file, ": ", what, " needs ", counted(size, "byte"), " at byte ", at, ", the file has ",
                    bytes.size());
  }
  return bytes.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(size));
}

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

inline constexpr std::string_view base64_alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Source  RFC 4648, section 4.
inline std::string to_base64(std::span<const std::byte> bytes) {
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k <= bytes.size() ? base64_alphabet[group >> (18 - 6 * k) & 63u] : '=';
    }
  }
  return out;
}

/// White space is skipped. `name` stands in messages. Throws io_error 403 on any other character outside the alphabet.
inline std::vector<std::byte> from_base64(std::string_view text, std::string_view name = "text") {
  std::vector<std::byte> out;
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t group = 0;
  int bits = 0;
  for (std::size_t i = 0; i < text.size() && text[i] != '='; ++i) {
    if (text[i] == '\n' || text[i] == '\r' || text[i] == ' ') continue;
    const std::size_t digit = base64_alphabet.find(text[i]);
    if (digit == std::string_view::npos) raise<io_error>(403, name, ": character ", i, " is not of base64");
    group = (group << 6 | static_cast<std::uint32_t>(digit)) & 0xFFFFFFu;
    if ((bits += 6) >= 8) out.push_back(static_cast<std::byte>(group >> (bits -= 8) & 255u));
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
