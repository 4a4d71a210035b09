// SPDX-License-Identifier: MIT
/// The three files of word vectors, as the HumanML3D evaluators and TM2T have them.
#pragma once

#include <string>
#include <vector>

#include <motionlang/file/file.hpp>
#include <motionlang/file/npy.hpp>

namespace glove_files {

/// A pickle of protocol 2: a list, or a dictionary from word to row.
inline std::string pickled(const std::vector<std::string>& list, bool rows) {
  std::string out = rows ? "\x80\x02}(" : "\x80\x02](";
  for (std::size_t i = 0; i < list.size(); ++i) {
    out += 'X';
    out += static_cast<char>(list[i].size());
    out.append(3, '\0');
    out += list[i];
    if (rows) out += std::string("K") + static_cast<char>(i);
  }
  return out + (rows ? "u." : "e.");
}

/// places: the words in the order of their rows.
inline void write(const std::string& stem, const std::vector<std::string>& words,
                  const std::vector<std::string>& places, const std::vector<float>& vectors) {
  namespace ml = motionlang;
  const auto rows = std::ssize(words);
  ml::write_npy(stem + "_data.npy",
                ml::NpyArray::of(std::span<const float>(vectors), {rows, std::ssize(vectors) / rows}));
  ml::write_file(stem + "_words.pkl", std::string_view(pickled(words, false)));
  ml::write_file(stem + "_idx.pkl", std::string_view(pickled(places, true)));
}

}  // namespace glove_files
