// SPDX-License-Identifier: MIT
/// The word vectors of the HumanML3D evaluators: three files with one stem ("our_vab").
///
///     stem_data.npy    (words, 300)
///     stem_words.pkl   list of words
///     stem_idx.pkl     word -> row
/// Source  spec text-encoders.md, section 6
#pragma once

#include <motionlang/io/npy.hpp>
#include <motionlang/io/pickle.hpp>
#include <motionlang/text/glove.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// Throws io_error 401 to 407; 403 if the files do not fit each other.
inline GloVe read_glove(const FilePath& stem) {
  const std::string base = stem.string(), data = base + "_data.npy", places = base + "_idx.pkl";
  const NpyArray array = read_npy(data);
  const Pickle words = Pickle::open(base + "_words.pkl"), index = Pickle::open(places);
  const PickleValue rows = index.root(), list = words.root();
  if (array.shape.size() != 2 || array.shape[0] != static_cast<Index>(list.size()) || rows.size() != list.size())
    raise<io_error>(403, data, ": not one row for each of ", list.size(), " words, of which ", places, " has ",
                    rows.size());
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

}  // namespace motionlang::inline MOTIONLANG_ABI
