// SPDX-License-Identifier: MIT
// Bodies of bytes.hpp.
#pragma once

#include <motionlang/file/detail/bytes.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::span<const std::byte> slice(std::span<const std::byte> bytes, std::uint64_t at, std::uint64_t size,
                                                 std::string_view file, std::string_view what) {
  if (at > bytes.size() || bytes.size() - at < size) {
    raise<io_error>(402, file, ": ", what, " needs ", counted(size, "byte"), " at byte ", at, ", the file has ",
                    bytes.size());
  }
  return bytes.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(size));
}

inline constexpr std::string_view base64_alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

MOTIONLANG_BODY std::string to_base64(std::span<const std::byte> bytes) {
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

MOTIONLANG_BODY std::vector<std::byte> from_base64(std::string_view text, std::string_view name) {
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
