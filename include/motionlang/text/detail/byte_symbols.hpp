// SPDX-License-Identifier: MIT
/// The symbols for bytes in vocabularies of byte-level pair encoding. Only bodies (*.ipp) include it.
#pragma once

#include <array>          // symbols
#include <string>         // symbols
#include <unordered_map>  // bytes of symbols

#include <motionlang/core/utf8.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The symbol of a byte in vocabularies. Printable bytes are their own symbols; the others are U+0100 ... in their
/// order.
struct ByteSymbols {
  std::array<std::string, 256> symbol;      // of a byte, UTF-8
  std::array<unsigned char, 256> in_order;  // the bytes in the order of the first ids: printable ones first
  std::unordered_map<char32_t, unsigned char> byte;

  ByteSymbols() {
    std::size_t count = 0;
    const auto printable = [](unsigned b) { return (b >= 0x21 && b <= 0x7E) || (b >= 0xA1 && b != 0xAD); };
    char32_t next = 0x100;
    for (const bool wanted : {true, false}) {
      for (unsigned b = 0; b < 256; ++b) {
        if (printable(b) != wanted) continue;
        const char32_t c = wanted ? char32_t{b} : next++;
        append_utf8(symbol[b], c);
        in_order[count++] = static_cast<unsigned char>(b);
        byte.emplace(c, static_cast<unsigned char>(b));
      }
    }
  }
  static const ByteSymbols& get() {
    static const ByteSymbols symbols;
    return symbols;
  }
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
