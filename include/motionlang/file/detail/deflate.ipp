// SPDX-License-Identifier: MIT
// Bodies of deflate.hpp.
#pragma once

#include <algorithm>  // min
#include <bit>        // bit_width
#include <cstdint>    // bits
#include <utility>    // exchange
#include <vector>     // places

#include <motionlang/file/detail/deflate.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The bits of a deflate stream, least significant first.
class BitWriter {
 public:
  void put(std::uint32_t bits, int count) {
    hold_ |= std::uint64_t{bits} << held_;
    for (held_ += count; held_ >= 8; held_ -= 8, hold_ >>= 8) out_ += static_cast<char>(hold_ & 255u);
  }
  /// A Huffman code, most significant bit first.
  void put_code(std::uint32_t code, int count) {
    std::uint32_t reversed = 0;
    for (int i = 0; i < count; ++i) reversed |= (code >> i & 1u) << (count - 1 - i);
    put(reversed, count);
  }
  std::string finish() {
    if (held_ > 0) put(0, 8 - held_);
    return std::move(out_);
  }

 private:
  std::string out_;
  std::uint64_t hold_ = 0;
  int held_ = 0;
};

/// Writes literals and matches with the fixed codes (RFC 1951, 3.2.6).
class FixedCodes {
 public:
  void literal(std::uint32_t symbol) {
    if (symbol < 144) return bits_.put_code(0x30 + symbol, 8);
    if (symbol < 256) return bits_.put_code(0x190 + symbol - 144, 9);
    if (symbol < 280) return bits_.put_code(symbol - 256, 7);
    bits_.put_code(0xC0 + symbol - 280, 8);
  }
  /// length  3 ... 258; distance 1 ... 32768. Both have groups that double in size: four groups for each size of
  ///         lengths, two for each size of distances.
  void match(std::uint32_t length, std::uint32_t distance) {
    if (length == 258) {
      literal(285);
    } else {
      const auto [symbol, extra, value] = group(length - 3, 4);
      literal(257 + symbol);
      bits_.put(value, extra);
    }
    const auto [symbol, extra, value] = group(distance - 1, 2);
    bits_.put_code(symbol, 5);
    bits_.put(value, extra);
  }
  void begin() { bits_.put(1 | 1 << 1, 3); }  // the last block, fixed codes
  std::string finish() {
    literal(256);
    return bits_.finish();
  }

 private:
  struct Group {
    std::uint32_t symbol;
    int extra;  // bits behind the symbol
    std::uint32_t value;
  };
  static Group group(std::uint32_t n, std::uint32_t each) {
    if (n < 2 * each) return {n, 0, 0};
    const int extra = static_cast<int>(std::bit_width(n / each)) - 1;
    return {(static_cast<std::uint32_t>(extra) * each) + (n >> extra), extra, n & ((1u << extra) - 1)};
  }

  BitWriter bits_;
};

MOTIONLANG_BODY std::string deflate(std::span<const std::byte> bytes) {
  constexpr std::size_t shortest = 3, longest = 258, farthest = 32768;
  std::vector<std::size_t> places(1 << 15, ~std::size_t{0});  // the last place of three bytes, by their hash
  const auto at = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
  const auto hash = [&](std::size_t i) { return ((at(i) << 16 | at(i + 1) << 8 | at(i + 2)) * 2654435761u) >> 17; };
  FixedCodes out;
  out.begin();
  for (std::size_t i = 0; i < bytes.size();) {
    std::size_t length = 0, from = 0;
    if (i + shortest <= bytes.size()) {
      from = std::exchange(places[hash(i)], i);
      if (from < i && i - from <= farthest) {
        const std::size_t most = std::min(longest, bytes.size() - i);
        while (length < most && bytes[from + length] == bytes[i + length]) ++length;
      }
    }
    if (length >= shortest) {
      out.match(static_cast<std::uint32_t>(length), static_cast<std::uint32_t>(i - from));
      i += length;
    } else {
      out.literal(at(i++));
    }
  }
  return out.finish();
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
