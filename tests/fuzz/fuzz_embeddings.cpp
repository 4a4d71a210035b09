// Caches of embeddings: the input is the three files, each behind its length of two bytes. They are read or refused
// with an error of the library; every text of a cache has its rows, and a text may be added to it.
#include <cstdint>

#include <motionlang/backend/reference.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/weights/embedding_cache.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

/// Takes a file off the front.
std::span<const std::byte> next_file(std::span<const std::byte>& rest) {
  if (rest.size() < 2) return {};
  const auto size = std::to_integer<std::size_t>(rest[0]) + 256 * std::to_integer<std::size_t>(rest[1]);
  rest = rest.subspan(2);
  const auto file = rest.first(std::min(size, rest.size()));
  rest = rest.subspan(file.size());
  return file;
}

void read(std::span<const std::byte> input) {
  const auto rows = next_file(input), slices = next_file(input), index = next_file(input);
  const std::string text(reinterpret_cast<const char*>(index.data()), index.size());
  auto cache =
      ml::EmbeddingCache::from_bytes(rows, slices.empty() ? std::nullopt : std::optional(slices), text, "fuzz");
  const auto document = ml::parse_json(text);
  for (const auto& entry : document.items()) {
    const auto found = cache.find(entry.key());
    check(cache.width() == 0 ? found.empty() : found.size() % static_cast<std::size_t>(cache.width()) == 0,
          "whole rows");
    const std::string one = entry.key();
    const auto features = cache.encode<B>(std::span(&one, 1));
    check(features.tokens.rows.count() == static_cast<ml::Index>(found.size()), "rows of a text");
  }
  const std::vector<float> row(static_cast<std::size_t>(std::min<ml::Index>(cache.width(), 4096)));
  if (cache.width() <= 4096 && !cache.contains("new")) {
    refusing([&] {
      cache.add("new", row);
      check(cache.find("new").size() == row.size(), "an added text is found");
    });
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  refusing([&] { read(std::as_bytes(std::span(data, size))); });
  return 0;
}
