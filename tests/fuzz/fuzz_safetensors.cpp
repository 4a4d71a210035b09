// safetensors: any bytes are read or refused with an io_error; what is read is JSON to another reader too, and survives
// writing. An input that begins with '{' is a header, up to the first line end, and the data behind it; others are
// files.
#include <cstdint>

#include <nlohmann/json.hpp>

#include <motionlang/file/safetensors.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

std::string as_file(std::string_view input) {
  if (!input.starts_with('{')) return std::string(input);
  const std::size_t length = std::min(input.find('\n'), input.size());
  const std::uint64_t n = length;
  std::string file(reinterpret_cast<const char*>(&n), sizeof n);
  file += input.substr(0, length);
  return file += input.substr(std::min(input.size(), length + 1));
}

void check_against_nlohmann(const ml::SafetensorsFile& file, std::string_view bytes) {
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), sizeof length);
  nlohmann::json header;
  try {
    header = nlohmann::json::parse(bytes.substr(sizeof length, length));
  } catch (const nlohmann::json::out_of_range&) {
    return;  // a number beyond double in a member that nobody reads: JSON all the same
  } catch (const nlohmann::json::parse_error&) {
    check(false, "the header is JSON to nlohmann");
  }
  for (const ml::TensorView& t : file.tensors()) {
    check(header.contains(t.name), "nlohmann finds the same names");
    check(header[t.name]["data_offsets"][1].get<std::uint64_t>() -
                  header[t.name]["data_offsets"][0].get<std::uint64_t>() ==
              t.bytes.size(),
          "nlohmann finds the same sizes");
  }
  check(header.size() == file.tensors().size() + header.contains("__metadata__"), "nlohmann finds as many names");
}

void check_round_trip(const ml::SafetensorsFile& file) {
  const auto written = ml::safetensors_bytes(file.tensors(), file.metadata());
  const auto again = ml::SafetensorsFile::from_bytes(written);
  check(again.metadata() == file.metadata() && again.names() == file.names(), "names survive");
  for (const ml::TensorView& t : file.tensors()) {
    const ml::TensorView& u = again.tensor(t.name);
    check(t.dtype == u.dtype && t.shape == u.shape, "types and shapes survive");
    check(std::equal(t.bytes.begin(), t.bytes.end(), u.bytes.begin(), u.bytes.end()), "bytes survive");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes = as_file({reinterpret_cast<const char*>(data), size});
  try {
    const auto file = ml::SafetensorsFile::from_bytes(std::as_bytes(std::span(bytes)));
    check_against_nlohmann(file, bytes);
    check_round_trip(file);
    for (const ml::TensorView& t : file.tensors()) {
      try {
        ml::values_of<double>(t);
        ml::values_of<std::int32_t>(t);
      } catch (const ml::io_error& e) {
        check(e.id() == 404 || e.id() == 407, "values are refused for their type only");
      }
    }
  } catch (const ml::io_error&) {}
  return 0;
}
