// SPDX-License-Identifier: MIT
/// Splits words into their longest known pieces, for word-piece tokenizers.
#pragma once

#include <algorithm>    // min
#include <string_view>  // words
#include <vector>       // ids

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Splits a word from the left into the longest known pieces and appends their ids; only `unknown` if that fails.
/// find(text, first) is the id of a piece that begins the word (first) or continues it, -1 if there is none.
template <class Find>
void append_longest_pieces(std::vector<Index>& ids, std::string_view word, std::size_t longest, Index unknown,
                           Find find) {
  const std::size_t before = ids.size();
  for (std::size_t at = 0; at < word.size();) {
    std::size_t length = std::min(word.size() - at, longest);
    Index id = -1;
    for (; length > 0 && (id = find(word.substr(at, length), at == 0)) < 0; --length) {}
    if (id < 0) {
      ids.resize(before);
      ids.push_back(unknown);
      return;
    }
    ids.push_back(id);
    at += length;
  }
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
