// SPDX-License-Identifier: MIT
/// Vectors of many words, in 8 bits a number: a text encoder that adds them to its own embedding hears that "stroll" is
/// near "walk", although no caption of its training says "stroll".
///
///     const WordVectors vectors = read_word_vectors("words.safetensors");        // weights/word_vector_file.hpp
///     if (const auto row = vectors.find("strolled")) use(vectors.vector(*row));  // of "stroll", if that is all it has
///
/// Number k of a vector is code_k * scale_k. 30,000 words of 64 numbers take 1.9 MB, and 0.25 MB for their letters.
#pragma once

#include <cstdint>      // codes
#include <memory>       // copies share the table
#include <optional>     // words without a vector
#include <span>         // vectors
#include <string>       // words
#include <string_view>  // lookups
#include <vector>       // tables

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class WordVectors {
 public:
  static constexpr bool is_option = true;  // holds no tensors

  /// No words.
  WordVectors() = default;
  /// The words are sorted; codes has a row of scales.size() for each. `source` stands in messages. Throws config_error
  /// 107 for words out of order or a scale that is not finite, shape_error 205 for another number of codes.
  WordVectors(std::vector<std::string> words, std::vector<std::int8_t> codes, std::vector<float> scales,
              std::string_view source = "WordVectors");
  /// Rounds vectors (words, width), in any order, to 8 bits: the largest number of a column becomes 127.
  /// Throws numeric_error 301 for a number that is not finite.
  static WordVectors rounded(std::span<const std::string> words, std::span<const float> vectors);

  bool empty() const { return size() == 0; }
  Index size() const { return table_ ? static_cast<Index>(table_->words.size()) : 0; }
  Index width() const { return table_ ? static_cast<Index>(table_->scales.size()) : 0; }
  const std::vector<std::string>& words() const { return table().words; }
  std::span<const std::int8_t> codes() const { return table().codes; }
  std::span<const float> scales() const { return table().scales; }

  /// The row of a word in lower case, or that of the word without -s, -es, -ed or -ing (text/word_forms.hpp).
  std::optional<Index> find(std::string_view word) const;
  /// 16 digits that change with any word or value.
  std::string checksum() const;
  /// The numbers of a row. Throws shape_error 203 if there is no such row.
  std::vector<float> vector(Index row) const;

 private:
  struct Table {
    std::vector<std::string> words{};  // sorted
    std::vector<std::int8_t> codes{};  // (words, width)
    std::vector<float> scales{};       // (width)
  };
  const Table& table() const;
  std::optional<Index> exact(std::string_view word) const;

  std::shared_ptr<const Table> table_;
};

/// The cosine between two vectors; 0 if one of them has no length.
double word_likeness(std::span<const float> a, std::span<const float> b);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/word_vectors.ipp>
#endif
