// Index files: any bytes are read or refused with an error of the library; what is read can be searched, changed and
// written, and read again. An input that begins with '{' is what a file says about itself, up to the first line end,
// then numbers for its vectors and moments, out of which a file with the right checksum is made; others are files.
#include <cstdint>

#include <motionlang/search/motion_index_file.hpp>
#include <motionlang/search/motion_search.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;
using ml::Index;

/// Vectors of two numbers, a byte for each angle; then four bytes for each moment.
std::vector<std::byte> as_file(std::string_view input) {
  const std::string_view about = input.substr(0, input.find('\n'));
  std::string_view rest = input.substr(std::min(input.size(), about.size() + 1));
  const auto take = [&]() -> int {
    if (rest.empty()) return 0;
    const int byte = static_cast<unsigned char>(rest.front());
    rest.remove_prefix(1);
    return byte;
  };
  std::array<std::vector<float>, 3> rows;
  for (auto& r : rows) {
    for (int count = take() % 8; count > 0; --count) {
      const float angle = static_cast<float>(take()) / 40;
      r.insert(r.end(), {std::cos(angle), std::sin(angle)});
    }
  }
  std::vector<std::int64_t> frames;
  while (rest.size() >= 3) frames.insert(frames.end(), {take() - 2, take() - 2, take() - 2});
  const auto table = [&](const char* name, const std::vector<float>& r) {
    return ml::tensor_view<float>(name, {std::ssize(r) / 2, 2}, r);
  };
  const std::vector<ml::TensorView> tensors{
      table("clips", rows[0]),
      table("moments", rows[1]),
      table("captions", rows[2]),
      ml::tensor_view<std::int64_t>("moment_frames", {std::ssize(frames) / 3, 3}, frames),
      {"about", ml::DType::U8, {std::ssize(about)}, std::as_bytes(std::span(about))}};
  return ml::safetensors_bytes(tensors, {{"format", ml::detail::index_format},
                                         {"version", ml::detail::index_version},
                                         {"checksum", ml::tensors_checksum(tensors)}});
}

void check_index(const ml::MotionIndex& index) {
  const auto written = ml::motion_index_bytes(index);
  const auto again = ml::MotionIndexFile::from_bytes(written).index();
  check(again.count() == index.count() && again.model().width == index.model().width, "an index survives writing");
  check(std::ranges::equal(again.moment_rows(), index.moment_rows()), "vectors survive writing");
  if (index.model().width != 2) return;
  const ml::MotionSearch search(index);
  const std::vector<float> query{1, 0.5};
  check(std::ssize(search.clips(query, 3)) == std::min<Index>(3, index.count()), "as many clips as there are");
  for (const auto& hit : search.captions(query, 3)) check(hit.clip < index.count(), "captions are of clips");
  if (!index.model().windows.empty()) {
    for (const auto& hit : search.moments(query, 3)) check(hit.clip < index.count(), "moments are of clips");
  }
  ml::MotionIndex less = index;
  less.remove_if([](const ml::IndexedClip& c) { return c.frames % 2 == 0; });
  ml::MotionIndexFile::from_bytes(ml::motion_index_bytes(less));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  refusing([&] {
    const auto bytes = input.starts_with('{') ? as_file(input) : std::vector<std::byte>();
    check_index(ml::MotionIndexFile::from_bytes(bytes.empty() ? std::as_bytes(std::span(input)) : bytes).index());
  });
  return 0;
}
