// SPDX-License-Identifier: MIT
// Bodies of inflate.hpp.
#pragma once

#include <algorithm>  // min
#include <array>      // code tables

#include <motionlang/file/detail/inflate.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::uint32_t crc32(std::span<const std::byte> bytes) {
  static constexpr auto table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int k = 0; k < 8; ++k) c = (c & 1u) != 0 ? 0xEDB88320u ^ c >> 1 : c >> 1;
      t[i] = c;
    }
    return t;
  }();
  std::uint32_t c = 0xFFFFFFFFu;
  for (const std::byte b : bytes) c = table[(c ^ std::to_integer<std::uint32_t>(b)) & 255u] ^ c >> 8;
  return ~c;
}

MOTIONLANG_BODY std::uint32_t adler32(std::span<const std::byte> bytes) {
  std::uint32_t a = 1, b = 0;
  for (const std::byte v : bytes) {
    a = (a + std::to_integer<std::uint32_t>(v)) % 65521;
    b = (b + a) % 65521;
  }
  return b << 16 | a;
}

/// The bits of a deflate stream, least significant first.
class BitReader {
 public:
  BitReader(std::span<const std::byte> bytes, std::string_view file) : bytes_(bytes), file_(file) {}

  /// The next n <= 16 bits without taking them; past the end they are 0.
  std::uint32_t peek(int n) {
    while (held_ < n) {
      if (at_ < bytes_.size()) hold_ |= std::to_integer<std::uint64_t>(bytes_[at_]) << held_;
      ++at_;
      held_ += 8;
    }
    return static_cast<std::uint32_t>(hold_ & ((std::uint64_t{1} << n) - 1));
  }
  /// Throws io_error 402 past the end.
  void drop(int n) {
    hold_ >>= n;
    held_ -= n;
    if (position() > bytes_.size()) raise<io_error>(402, file_, ": deflated data ends too early");
  }
  std::uint32_t take(int n) {
    const std::uint32_t bits = peek(n);
    drop(n);
    return bits;
  }
  /// To the next whole byte.
  void align() { drop(held_ % 8); }
  /// Whole bytes taken so far.
  std::size_t position() const { return at_ - static_cast<std::size_t>(held_ / 8); }

  /// `size` bytes after align().
  std::span<const std::byte> take_bytes(std::size_t size) {
    at_ = position();
    hold_ = 0;
    held_ = 0;
    const auto part = slice(bytes_, at_, size, file_, "stored block");
    at_ += size;
    return part;
  }
  [[noreturn]] void malformed(const char* what) const {
    raise<io_error>(403, file_, ": deflated data: ", what, " at byte ", position());
  }

 private:
  std::span<const std::byte> bytes_;
  std::string_view file_;
  std::size_t at_ = 0;
  std::uint64_t hold_ = 0;
  int held_ = 0;
};

/// A canonical Huffman code (RFC 1951, 3.2.2): symbols of equal length have consecutive codes.
class HuffmanCode {
 public:
  /// lengths   bits of the code of each symbol; 0 for a symbol that does not occur
  HuffmanCode(std::span<const std::uint8_t> lengths, const BitReader& in) {
    for (const std::uint8_t n : lengths) ++count_[n];
    count_[0] = 0;
    int free = 1, used = 0;
    for (std::size_t n = 1; n <= longest; ++n) {
      free = 2 * free - count_[n];
      used += count_[n];
      if (free < 0) in.malformed("over-subscribed code");
    }
    if (free > 0 && !(used == 0 || (used == 1 && count_[1] == 1))) in.malformed("incomplete code");

    std::array<std::uint16_t, longest + 2> next_code{}, next_place{};
    for (std::size_t n = 1; n <= longest; ++n) {
      next_code[n + 1] = static_cast<std::uint16_t>((next_code[n] + count_[n]) << 1);
      next_place[n + 1] = static_cast<std::uint16_t>(next_place[n] + count_[n]);
    }
    for (std::size_t symbol = 0; symbol < lengths.size(); ++symbol) {
      const std::size_t n = lengths[symbol];
      if (n == 0) continue;
      symbols_[next_place[n]++] = static_cast<std::uint16_t>(symbol);
      const std::uint32_t code = next_code[n]++;
      if (n > quick_bits) continue;
      for (std::uint32_t rest = 0; rest < 1u << (quick_bits - n); ++rest) {
        quick_[reversed(code, n) | rest << n] = static_cast<std::uint16_t>(symbol << 4 | n);
      }
    }
  }

  std::uint32_t decode(BitReader& in) const {
    if (const std::uint32_t q = quick_[in.peek(quick_bits)]; q != 0) {
      in.drop(static_cast<int>(q & 15u));
      return q >> 4;
    }
    std::uint32_t code = 0, first = 0, place = 0;
    for (std::size_t n = 1; n <= longest; ++n) {
      code |= in.take(1);
      if (code - first < count_[n]) return symbols_[place + code - first];
      place += count_[n];
      first = (first + count_[n]) << 1;
      code <<= 1;
    }
    in.malformed("a code that is not in the table");
  }

 private:
  static constexpr std::size_t longest = 15, quick_bits = 9;

  static std::uint32_t reversed(std::uint32_t code, std::size_t n) {
    std::uint32_t r = 0;
    for (; n > 0; --n, code >>= 1) r = r << 1 | (code & 1u);
    return r;
  }
  std::array<std::uint16_t, longest + 1> count_{};
  std::array<std::uint16_t, 288> symbols_{};
  std::array<std::uint16_t, 1 << quick_bits> quick_{};  // symbol << 4 | length for codes of up to 9 bits
};

/// The two codes of one block.
struct BlockCodes {
  HuffmanCode literal, distance;

  /// RFC 1951, 3.2.6.
  static BlockCodes fixed(const BitReader& in) {
    std::array<std::uint8_t, 288> literal{};
    for (std::size_t i = 0; i < 288; ++i) literal[i] = i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8;
    std::array<std::uint8_t, 32> distance{};
    distance.fill(5);
    return {HuffmanCode(literal, in), HuffmanCode(distance, in)};
  }
  /// RFC 1951, 3.2.7.
  static BlockCodes dynamic(BitReader& in) {
    const std::size_t literals = in.take(5) + 257, distances = in.take(5) + 1, count = in.take(4) + 4;
    if (literals > 286 || distances > 30) in.malformed("too many codes");
    static constexpr std::array<std::uint8_t, 19> order{16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                        11, 4,  12, 3, 13, 2, 14, 1, 15};
    std::array<std::uint8_t, 19> meta_lengths{};
    for (std::size_t i = 0; i < count; ++i) meta_lengths[order[i]] = static_cast<std::uint8_t>(in.take(3));
    const HuffmanCode meta(meta_lengths, in);

    std::array<std::uint8_t, 286 + 30> lengths{};
    const std::size_t total = literals + distances;
    for (std::size_t i = 0; i < total;) {
      const std::uint32_t symbol = meta.decode(in);
      if (symbol < 16) {
        lengths[i++] = static_cast<std::uint8_t>(symbol);
        continue;
      }
      if (symbol == 16 && i == 0) in.malformed("a repetition of nothing");
      const std::uint8_t repeated = symbol == 16 ? lengths[i - 1] : std::uint8_t{0};
      const std::size_t n = symbol == 16 ? 3 + in.take(2) : symbol == 17 ? 3 + in.take(3) : 11 + in.take(7);
      if (i + n > total) in.malformed("too many code lengths");
      for (const std::size_t end = i + n; i < end; ++i) lengths[i] = repeated;
    }
    if (lengths[256] == 0) in.malformed("a block without an end");
    const std::span<const std::uint8_t> all(lengths);
    return {HuffmanCode(all.first(literals), in), HuffmanCode(all.subspan(literals, distances), in)};
  }
};

inline void append_bytes(ByteCount& out, std::span<const std::byte> bytes) { out.bytes += bytes.size(); }

/// Appends `length` bytes, each a copy of the byte `distance` before it.
inline void repeat(ByteCount& out, std::size_t, std::size_t length) { out.bytes += length; }

inline void repeat(std::vector<std::byte>& out, std::size_t distance, std::size_t length) {
  for (std::size_t k = 0; k < length; ++k) out.push_back(out[out.size() - distance]);
}

template <class Out>
std::size_t inflate_stream(Out& out, std::span<const std::byte> stream, std::size_t limit, std::string_view file,
                           std::size_t enough) {
  // RFC 1951, 3.2.5: symbols 257 ... 285 and 0 ... 29
  static constexpr std::array<std::uint16_t, 29> length_base{3,  4,  5,  6,   7,   8,   9,   10,  11, 13,
                                                             15, 17, 19, 23,  27,  31,  35,  43,  51, 59,
                                                             67, 83, 99, 115, 131, 163, 195, 227, 258};
  static constexpr std::array<std::uint8_t, 29> length_bits{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                                            2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
  static constexpr std::array<std::uint16_t, 30> distance_base{
      1,   2,   3,   4,   5,   7,    9,    13,   17,   25,   33,   49,   65,    97,    129,
      193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
  BitReader in(stream, file);
  auto room_for = [&](std::size_t n) {
    if (limit - out.size() < n) raise<io_error>(405, file, ": deflated data gives more than ", limit, " bytes");
  };
  for (bool last = false; !last && out.size() < enough;) {
    last = in.take(1) != 0;
    const std::uint32_t kind = in.take(2);
    if (kind == 3) in.malformed("unknown kind of block");
    if (kind == 0) {
      in.align();
      const std::uint32_t size = in.take(16);
      if ((in.take(16) ^ size) != 0xFFFFu) in.malformed("length of a stored block");
      room_for(size);
      append_bytes(out, in.take_bytes(size));
      continue;
    }
    const BlockCodes codes = kind == 1 ? BlockCodes::fixed(in) : BlockCodes::dynamic(in);
    for (std::uint32_t symbol = codes.literal.decode(in); symbol != 256; symbol = codes.literal.decode(in)) {
      if (symbol < 256) {
        room_for(1);
        out.push_back(static_cast<std::byte>(symbol));
        if (out.size() >= enough) break;
        continue;
      }
      if (symbol > 285) in.malformed("unknown length");
      const std::size_t length = length_base[symbol - 257] + in.take(length_bits[symbol - 257]);
      const std::uint32_t d = codes.distance.decode(in);
      if (d > 29) in.malformed("unknown distance");
      const std::size_t distance = distance_base[d] + in.take(static_cast<int>(d < 2 ? 0 : d / 2 - 1));
      if (distance > out.size()) in.malformed("a distance before the start");
      room_for(length);
      repeat(out, distance, length);
      if (out.size() >= enough) break;
    }
  }
  return in.position();
}

MOTIONLANG_BODY std::size_t inflate_to(std::vector<std::byte>& out, std::span<const std::byte> stream,
                                       std::size_t limit, std::string_view file, std::size_t enough) {
  return inflate_stream(out, stream, limit, file, enough);
}

MOTIONLANG_BODY std::size_t inflate_to(ByteCount& out, std::span<const std::byte> stream, std::size_t limit,
                                       std::string_view file, std::size_t enough) {
  return inflate_stream(out, stream, limit, file, enough);
}

MOTIONLANG_BODY Inflated inflate(std::span<const std::byte> stream, std::size_t limit, std::string_view file,
                                 std::size_t expected) {
  Inflated out;
  out.data.reserve(expected);
  out.consumed = inflate_to(out.data, stream, limit, file);
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
