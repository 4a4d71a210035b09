// SPDX-License-Identifier: MIT
/// A table of texts that finds those nearest in meaning to another text.
///
///     const auto table = TextTable::encoded(captions, text_vectors(encoder));   // any encoder with a vector per text
///     for (const NearText& near : table.nearest("have a seat", 3))
///       std::cout << near.text << ' ' << near.likeness << '\n';                 // sit down 0.8
///
/// Two things make texts alike. Their vectors point in the same direction from the mean of the table, and the table's
/// text says the words of the other, or words like them. A rare word counts more than a common one. So a text with a
/// word that nobody knows is far from every text, although an encoder puts its vector somewhere.
///
///     likeness = max(0, cos(vector - mean, vector' - mean)) (0.01 + 0.99 words)
///     words    = sum_w rarity_w max_v alike(w, v) / sum_w rarity_w
///     rarity_w = log((1 + texts) / (1 + texts with w))
///     alike    = 1 for the same word, else the cosine between the words' vectors, and 0 without these
#pragma once

#include <cstdint>      // codes
#include <functional>   // encoders
#include <memory>       // copies share the table
#include <set>          // words
#include <span>         // texts
#include <string>       // texts
#include <string_view>  // messages
#include <vector>       // tables

#include <motionlang/text/word_vectors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Gives the vectors of texts, (texts, width), one after the other.
using TextVectors = std::function<std::vector<float>(std::span<const std::string>)>;

/// The same by a network that maps texts to a tensor (texts, width), such as CaptionEncoder. The function keeps it.
template <class Encoder>
TextVectors text_vectors(Encoder encoder) {
  return [encoder = std::move(encoder)](std::span<const std::string> texts) {
    const auto rows = encoder(texts);
    return std::vector<float>(rows.span().begin(), rows.span().end());
  };
}

/// A text of a table, and how alike it is to another: 1 for the same, 0 for one that has nothing in common with it.
struct NearText {
  Index row = 0;
  std::string text{};
  double likeness = 0;
  double said = 0;  // the share of its own words that the other says, or words like them, by their rarity
};

namespace detail {

/// True for words that say nothing about a motion: "the", "your", "person", "performs".
const std::set<std::string>& function_words();
inline bool is_function_word(const std::string& word) { return function_words().contains(word); }

}  // namespace detail

class TextTable {
 public:
  /// No texts.
  TextTable() = default;
  /// From what `codes` and `mean` gave. codes: (texts, width). `source` stands in messages. Throws shape_error 205 for
  /// another number of codes.
  TextTable(std::vector<std::string> texts, std::vector<std::int8_t> codes, std::vector<float> mean, TextVectors encode,
            WordVectors words = {}, std::string_view source = "TextTable");
  /// Encodes the texts now. words: vectors of words, which tell how alike two words are; none: only the same are.
  /// Throws shape_error 205 for vectors of different widths, numeric_error 301 for a value that is not finite, and what
  /// `encode` throws.
  static TextTable encoded(std::vector<std::string> texts, TextVectors encode, WordVectors words = {});

  /// Other texts by the encoder of this table, which has its own mean. An empty table stays empty. Throws what
  /// `encoded` throws.
  TextTable encoded_again(std::vector<std::string> texts) const;
  /// The table with more texts at its end, which are encoded now. The mean stays. An empty table stays empty. Throws
  /// what `encoded` throws.
  TextTable with(const std::vector<std::string>& more) const;
  /// The first texts alone. Throws shape_error 203 if there are fewer.
  TextTable first(Index count) const;

  bool empty() const { return size() == 0; }
  Index size() const { return table_ ? static_cast<Index>(table_->texts.size()) : 0; }
  const std::vector<std::string>& texts() const { return table().texts; }
  /// The directions of the texts from their mean, in 8 bits a number: the largest number of a text is 127.
  std::span<const std::int8_t> codes() const { return table().codes; }
  std::span<const float> mean() const { return table().mean; }
  const WordVectors& words() const { return table().words; }
  /// The words of the texts, without those that say nothing, in alphabetical order.
  const std::vector<std::string>& said_words() const;
  /// The word for a misspelled one: "forward" for "foreward". The texts do not say the misspelled word, and it has no
  /// vector. Both words begin alike, and one step turns one into the other (edit_distance), or two if it has more than
  /// seven letters. "" if there is no such word, or if the table has no vectors, which tell what words exist.
  std::string mended(const std::string& word) const;

  /// At most `count` texts, the nearest first.
  /// wanted  rows that may be found; none: all
  std::vector<NearText> nearest(const std::string& text, Index count,
                                const std::function<bool(Index)>& wanted = {}) const;
  /// The nearest of several texts each, which are encoded together.
  std::vector<std::vector<NearText>> nearest(std::span<const std::string> texts, Index count,
                                             const std::function<bool(Index text, Index row)>& wanted = {}) const;

 private:
  struct Words;
  struct Table {
    std::vector<std::string> texts{};
    std::vector<std::int8_t> codes{};
    std::vector<float> mean{};
    TextVectors encode{};
    WordVectors words{};
    std::shared_ptr<const Words> said{};  // in the texts
  };
  const Table& table() const;
  struct Likeness {
    double likeness = 0, said = 0;
  };
  std::vector<Likeness> likeness(const std::string& text, std::span<const float> vector) const;

  std::shared_ptr<const Table> table_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/text/text_table.ipp>
#endif
