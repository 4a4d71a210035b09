// SPDX-License-Identifier: MIT
/// A checksum of many bytes at the speed of memory. It protects against accidents, not against forgery.
#pragma once

#include <cstdint>  // words
#include <cstring>  // memcpy
#include <span>     // bytes
#include <string>   // hexadecimal digits

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// FNV-1a, byte by byte.
inline std::uint64_t byte_hash(std::span<const std::byte> bytes, std::uint64_t before = 0xCBF29CE484222325u) {
  for (const std::byte b : bytes) before = (before ^ static_cast<std::uint64_t>(b)) * 0x100000001B3u;
  return before;
}

/// FNV-1a over words of 64 bits in four lanes, then over the lanes, the remaining bytes and the length. Every step is
/// invertible, so one changed word always changes the result.
inline std::uint64_t content_hash(std::span<const std::byte> bytes, std::uint64_t before = 0xCBF29CE484222325u) {
  constexpr std::uint64_t prime = 0x100000001B3u;
  std::uint64_t lanes[4] = {before, before ^ 1u, before ^ 2u, before ^ 3u}, words[4];
  const std::uint64_t size = bytes.size();
  for (; bytes.size() >= sizeof words; bytes = bytes.subspan(sizeof words)) {
    std::memcpy(words, bytes.data(), sizeof words);
    for (int i = 0; i < 4; ++i) lanes[i] = (lanes[i] ^ words[i]) * prime;
  }
  std::uint64_t h = before;
  for (const std::uint64_t lane : lanes) h = (h ^ lane) * prime;
  h = (byte_hash(bytes, h) ^ size) * prime;
  return h ^ h >> 32;
}

inline std::string hexadecimal(std::uint64_t value) {
  std::string out(16, '0');
  for (std::size_t i = 16; i-- > 0; value >>= 4) out[i] = "0123456789abcdef"[value & 15u];
  return out;
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
