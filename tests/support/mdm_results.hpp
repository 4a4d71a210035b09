// SPDX-License-Identifier: MIT
/// The bytes of a results.npy as sample/generate.py of MDM leaves it: numpy.save (NumPy 1.24, pickle protocol 3) of one
/// dictionary. Bytes of numbers and texts are put between what NumPy wrote.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <motionlang/file/npy.hpp>

namespace mdm {

inline std::string little_endian(std::size_t n) {
  std::string out;
  for (int byte = 0; byte < 4; ++byte) out += static_cast<char>(n >> 8 * byte & 0xFF);
  return out;
}
inline std::string pickled_text(std::string_view text) {
  return motionlang::concat_text("X", little_endian(text.size()), text);
}
inline std::string pickled_bytes(std::string_view bytes) {
  return motionlang::concat_text("B", little_endian(bytes.size()), bytes);
}
inline std::string pickled_int(std::size_t n) { return "J" + little_endian(n); }

/// motion  of 32-bit floats, (n, joints, 3, frames)
inline std::string results(const motionlang::NpyArray& motion, const std::vector<std::string>& texts,
                           const std::vector<std::int64_t>& lengths) {
  using namespace std::string_view_literals;
  const auto bytes_of = [](const auto& v) {
    return std::string_view(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(v[0]));
  };
  std::string header = "{'descr': '|O', 'fortran_order': False, 'shape': (), }";
  header.append(117 - header.size(), ' ');
  std::string out = motionlang::concat_text("\x93NUMPY\x01\x00v\x00"sv, header, "\n");
  out +=
      "\x80\x03"
      "cnumpy.core.multiarray\n_reconstruct\nq\x00"
      "cnumpy\nndarray\nq\x01K\x00\x85q\x02"
      "C\x01"
      "bq\x03\x87q\x04Rq\x05(K\x01)cnumpy\ndtype\nq\x06X\x02\x00\x00\x00O8q\x07\x89\x88\x87q\x08Rq\x09("
      "K\x03X\x01\x00\x00\x00|q\x0a"
      "NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK?tq\x0b"
      "b\x89]q\x0c}q\x0d(X\x06\x00\x00\x00motionq\x0e"
      "h\x00h\x01K\x00\x85q\x0fh\x03\x87q\x10Rq\x11(K\x01("sv;
  for (const motionlang::Index n : motion.shape) out += pickled_int(static_cast<std::size_t>(n));
  out +=
      "tq\x12h\x06X\x02\x00\x00\x00"
      "f4q\x13\x89\x88\x87q\x14Rq\x15(K\x03X\x01\x00\x00\x00<q\x16NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK\x00tq\x17"
      "b\x89"sv;
  out += pickled_bytes(bytes_of(motion.data));
  out +=
      "q\x18tq\x19"
      "bX\x04\x00\x00\x00textq\x1a]q\x1b("sv;
  for (const std::string& text : texts) out += pickled_text(text);
  out += "eX\x07\x00\x00\x00lengthsq\x1eh\x00h\x01K\x00\x85q\x1fh\x03\x87q Rq!(K\x01"sv;
  out += pickled_int(lengths.size());
  out +=
      "\x85q\"h\x06X\x02\x00\x00\x00i8q#\x89\x88\x87q$Rq%(K\x03h\x16NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xff"
      "K\x00tq&b\x89"sv;
  out += pickled_bytes(bytes_of(lengths));
  out += "q'tq(bX\x0b\x00\x00\x00num_samplesq)K\x03X\x0f\x00\x00\x00num_repetitionsq*K\x01uatq+b."sv;
  return out;
}

}  // namespace mdm
