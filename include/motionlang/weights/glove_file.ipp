// SPDX-License-Identifier: MIT
// Bodies of glove_file.hpp.
#pragma once

#include <motionlang/file/npy.hpp>
#include <motionlang/file/pickle.hpp>
#include <motionlang/weights/glove_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY GloVe read_glove(const FilePath& stem) {
  const std::string& base = stem.string();
  const std::string data = base + "_data.npy", places = base + "_idx.pkl";
  const NpyArray array = read_npy(data);
  const Pickle words = Pickle::open(base + "_words.pkl"), index = Pickle::open(places);
  const PickleValue rows = index.root(), list = words.root();
  if (array.shape.size() != 2 || array.shape[0] != static_cast<Index>(list.size()) || rows.size() != list.size())
    raise<io_error>(403, data, ": not one row for each of ", counted(list.size(), "word"), ", of which ", places,
                    " has ", rows.size());
  std::vector<std::string> in_order(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::int64_t row = rows.value(i).integer();
    if (row < 0 || row >= static_cast<std::int64_t>(list.size()) || !in_order[static_cast<std::size_t>(row)].empty())
      rows.value(i).fail(403, "row ", row, " is not the one of a word among ", list.size());
    in_order[static_cast<std::size_t>(row)] = rows.key(i).text();
  }
  GloVe out(in_order, array.to<float>(), array.shape[1]);
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (const std::string word(list[i].text()); !out.contains(word))
      list[i].fail(403, "the word '", word, "' has no row");
  }
  return out;
}

namespace detail {

/// A pickle of protocol 2: the list of the words, or a dictionary from each to its row.
inline std::string pickled_words(std::span<const std::string> words, bool rows) {
  std::string out = rows ? "\x80\x02}(" : "\x80\x02](";
  const auto number = [&](std::size_t n) {  // four bytes, the lowest first
    for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(n >> shift & 0xff);
  };
  for (std::size_t i = 0; i < words.size(); ++i) {
    out += 'X';
    number(words[i].size());
    out += words[i];
    if (!rows) continue;
    out += 'J';
    number(i);
  }
  return out + (rows ? "u." : "e.");
}

}  // namespace detail

MOTIONLANG_BODY void write_glove(const FilePath& stem, const GloVe& glove) {
  const std::string& base = stem.string();
  const std::vector<std::string> words = glove.words();
  std::vector<float> vectors;
  for (const std::string& word : words) {
    const auto row = glove.vector(word);
    vectors.insert(vectors.end(), row.begin(), row.end());
  }
  write_npy(base + "_data.npy", NpyArray::of(std::span<const float>(vectors), {glove.size(), glove.width()}));
  write_file(base + "_words.pkl", std::string_view(detail::pickled_words(words, false)));
  write_file(base + "_idx.pkl", std::string_view(detail::pickled_words(words, true)));
}

MOTIONLANG_NAMESPACE_END
