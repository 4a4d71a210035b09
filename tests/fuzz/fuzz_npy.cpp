// npy: any bytes are read or refused with an io_error; what was read has as many bytes as its shape says, and survives
// writing.
#include <cstdint>

#include <motionlang/file/npy.hpp>

#include "check.hpp"

namespace ml = motionlang;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const ml::NpyArray array = ml::parse_npy(std::as_bytes(std::span(data, size)), "npy");
    check(array.data.size() == static_cast<std::size_t>(array.count()) * array.item_size, "bytes of the shape");
    const ml::NpyArray again = ml::parse_npy(ml::npy_bytes(array), "again");
    check(again.type() == array.type() && again.shape == array.shape && again.data == array.data, "round trip");
    if (array.is_text()) {
      check(std::ssize(array.texts()) == array.count(), "number of texts");
    } else {
      check(std::ssize(array.to<double>()) == array.count(), "number of values");
      try {
        array.to<std::int32_t>();
      } catch (const ml::io_error& e) {
        check(e.id() == 407, "integers are refused for their type or range only");
      }
    }
  } catch (const ml::io_error&) {}
  return 0;
}
