// SPDX-License-Identifier: MIT
// Bodies of word_vectors.hpp.
#pragma once

#include <algorithm>  // clamp, lower_bound, sort
#include <cmath>      // round
#include <numeric>    // iota

#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/text/word_forms.hpp>
#include <motionlang/text/word_vectors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY WordVectors::WordVectors(std::vector<std::string> words, std::vector<std::int8_t> codes,
                                         std::vector<float> scales, std::string_view source) {
  if (scales.empty() || codes.size() != words.size() * scales.size())
    raise<shape_error>(205, source, ": ", counted(codes.size(), "number"), " for ", counted(words.size(), "word"),
                       " of ", scales.size());
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (!(words[i - 1] < words[i]))
      raise<config_error>(107, source, ": word ", i, " is '", words[i], "' behind '", words[i - 1],
                          "', but words are sorted and each is there once");
  }
  for (std::size_t k = 0; k < scales.size(); ++k) {
    if (!std::isfinite(scales[k])) raise<config_error>(107, source, ": scale ", k, " is ", scales[k]);
  }
  table_ = std::make_shared<const Table>(Table{std::move(words), std::move(codes), std::move(scales)});
}

MOTIONLANG_BODY WordVectors WordVectors::rounded(std::span<const std::string> words, std::span<const float> vectors) {
  if (words.empty() || vectors.empty() || vectors.size() % words.size() != 0)
    raise<shape_error>(205, "WordVectors: ", counted(vectors.size(), "number"), " for ", counted(words.size(), "word"));
  const std::size_t width = vectors.size() / words.size();
  std::vector<float> scales(width);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    if (!std::isfinite(vectors[i]))
      raise<numeric_error>(301, "WordVectors: number ", i % width, " of '", words[i / width], "' is ", vectors[i]);
    scales[i % width] = std::max(scales[i % width], std::abs(vectors[i]) / 127);
  }
  std::vector<std::size_t> order(words.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return words[a] < words[b]; });
  std::vector<std::string> sorted;
  std::vector<std::int8_t> codes;
  for (const std::size_t i : order) {
    sorted.push_back(words[i]);
    for (std::size_t k = 0; k < width; ++k) {
      const float scale = scales[k];
      const double steps = scale == 0 ? 0 : std::round(vectors[i * width + k] / scale);
      codes.push_back(static_cast<std::int8_t>(std::clamp(steps, -127.0, 127.0)));
    }
  }
  return {std::move(sorted), std::move(codes), std::move(scales)};
}

MOTIONLANG_BODY const WordVectors::Table& WordVectors::table() const {
  static const Table none;
  return table_ ? *table_ : none;
}

MOTIONLANG_BODY std::optional<Index> WordVectors::exact(std::string_view word) const {
  const auto& words = table().words;
  const auto found = std::lower_bound(words.begin(), words.end(), word);
  if (found == words.end() || *found != word) return std::nullopt;
  return static_cast<Index>(found - words.begin());
}

MOTIONLANG_BODY std::optional<Index> WordVectors::find(std::string_view word) const {
  if (empty()) return std::nullopt;
  return exact(known_form(std::string(word), [this](const std::string& form) { return exact(form).has_value(); }));
}

MOTIONLANG_BODY std::vector<float> WordVectors::vector(Index row) const {
  if (row < 0 || row >= size()) raise<shape_error>(203, "WordVectors: row ", row, " of ", size());
  const auto codes = this->codes().subspan(static_cast<std::size_t>(row * width()));
  std::vector<float> out;
  for (std::size_t k = 0; k < scales().size(); ++k) out.push_back(static_cast<float>(codes[k]) * scales()[k]);
  return out;
}

MOTIONLANG_BODY std::string WordVectors::checksum() const {
  std::uint64_t hash = detail::content_hash(std::as_bytes(codes()));
  hash = detail::content_hash(std::as_bytes(scales()), hash);
  for (const std::string& word : words()) hash = detail::content_hash(std::as_bytes(std::span(word)), hash);
  return detail::hexadecimal(hash);
}

MOTIONLANG_BODY double word_likeness(std::span<const float> a, std::span<const float> b) {
  if (a.size() != b.size())
    raise<shape_error>(202, "word_likeness: vectors of ", a.size(), " and ", b.size(), " numbers");
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double x = a[k], y = b[k];
    ab += x * y, aa += x * x, bb += y * y;
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

MOTIONLANG_NAMESPACE_END
