// Dumps of joblib as bytes, plain and packed.
#pragma once

#include <cstring>
#include <string>

#include <motionlang/file/detail/deflate.hpp>
#include <motionlang/file/detail/inflate.hpp>
#include <motionlang/file/png.hpp>

/// One array of `size` bytes, all of them `value`.
inline std::string joblib_dump(std::uint32_t size, char value) {
  std::string dump =
      "\x80\x02"
      "cjoblib.numpy_pickle\nNumpyArrayWrapper\n)\x81}(U\x05"
      "dtypecnumpy\ndtype\n(U\x02u1tR"
      "(K\x03U\x01|tbU\x05orderU\x01"
      "CU\x05shape(J";
  dump.append(reinterpret_cast<const char*>(&size), sizeof size);
  return dump + "tub" + std::string(size, value) + ".";
}

inline std::string as_zlib(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return "\x78\x9C" + motionlang::detail::deflate(bytes) +
         motionlang::detail::big_endian(motionlang::detail::adler32(bytes));
}
