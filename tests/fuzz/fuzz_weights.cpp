// Files of weights in every format: any bytes are read or refused with an error of the library; tensors hold as many
// bytes as their shape says, and survive being written as safetensors. A pickle is read once more as the data.pkl of an
// archive of PyTorch with two storages, which keeps checksums out of the way.
#include <array>
#include <cstdint>

#include <motionlang/file/torch_file.hpp>
#include <motionlang/file/zip.hpp>
#include <motionlang/weights/weight_file.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

void check_round_trip(const ml::WeightFile& file) {
  const auto written = ml::safetensors_bytes(file.tensors());
  const auto again = ml::WeightFile::from_bytes(written, "again");
  check(again.format() == "safetensors" && again.names() == file.names(), "names survive");
  for (const ml::TensorView& t : file.tensors()) {
    const ml::TensorView& u = again.tensor(t.name);
    check(t.dtype == u.dtype && t.shape == u.shape, "types and shapes survive");
    check(std::equal(t.bytes.begin(), t.bytes.end(), u.bytes.begin(), u.bytes.end()), "bytes survive");
  }
}

void read(std::span<const std::byte> bytes) {
  try {
    const auto file = ml::WeightFile::from_bytes(bytes, "fuzz");
    std::size_t size = 0;
    for (const ml::TensorView& t : file.tensors()) {
      const auto bits = static_cast<std::size_t>(t.shape.count()) * static_cast<std::size_t>(info(t.dtype).bits);
      check(bits == 8 * t.bytes.size(), "bytes of a tensor");
      check(file.find(t.name) == &t, "a tensor is found by its name");
      size += t.bytes.size();
    }
    for (const ml::FileValue& v : std::span(file.values()).first(std::min<std::size_t>(file.values().size(), 100)))
      check(file.value(v.path) != nullptr, "a value is found by its path");
    constexpr std::size_t large = 1 << 20;  // tensors may share their bytes
    if (size < large) check_round_trip(file);
  } catch (const ml::error&) {}
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  read(bytes);
  if (size > 1 && data[0] == 0x80 && !ml::TorchFile::is_legacy(bytes)) {
    std::array<std::byte, 64> storage{};
    for (std::size_t i = 0; i < storage.size(); ++i) storage[i] = static_cast<std::byte>(i);
    ml::ZipWriter zip;
    zip.add("r/data.pkl", bytes);
    zip.add("r/data/0", storage);
    zip.add("r/data/1", std::span(storage).first(24));
    read(zip.finish());
  }
  return 0;
}
