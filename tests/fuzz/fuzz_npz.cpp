// npz: any bytes are read as a zip archive or refused with an io_error; members that can be read survive writing.
#include <cstdint>

#include <motionlang/file/npz.hpp>

#include "check.hpp"

namespace ml = motionlang;

namespace {

constexpr std::uint64_t largest_member = 1 << 20;  // what a member says that it unpacks to, for the fuzzer's speed

void check_members(const ml::ZipArchive& zip, std::span<const std::byte> file) {
  for (const ml::ZipEntry& entry : zip.entries()) {
    check(entry.offset <= file.size() && entry.packed <= file.size() - entry.offset, "a member lies inside the file");
    check(zip.find(entry.name) == &entry, "a member is found by its name");
    if (entry.size > largest_member) continue;
    try {
      check(zip.read(entry).size() == entry.size, "size of a member");
    } catch (const ml::io_error&) {}
  }
}

void check_round_trip(const ml::NpzArchive& npz) {
  std::vector<ml::NamedArray> arrays;
  for (const std::string& name : npz.names()) {
    try {
      arrays.push_back({name, npz.read(name)});
    } catch (const ml::io_error&) {}
  }
  const auto bytes = ml::npz_bytes(arrays);
  const ml::NpzArchive again(ml::ZipArchive(bytes, "again"));
  check(again.names().size() == arrays.size(), "number of arrays");
  for (const auto& [name, array] : arrays) {
    const ml::NpyArray copy = again.read(name);
    check(copy.type() == array.type() && copy.shape == array.shape && copy.data == array.data, "arrays survive");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  try {
    const ml::ZipArchive zip(bytes, "npz");
    check_members(zip, bytes);
    for (const ml::ZipEntry& entry : zip.entries()) {
      if (entry.size > largest_member) return 0;
    }
    check_round_trip(ml::NpzArchive(zip));
  } catch (const ml::io_error&) {}
  return 0;
}
