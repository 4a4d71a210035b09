// SPDX-License-Identifier: MIT
// Bodies of stmc_start.hpp.
#pragma once

#include <motionlang/train/stmc_start.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<float> started_rows(const WordPiece& wanted, const WordPiece& known,
                                                const std::vector<float>& rows, bool has_vectors) {
  const std::size_t width = rows.size() / static_cast<std::size_t>(known.size());
  const auto value = [&](Index id, std::size_t w) { return rows[static_cast<std::size_t>(id) * width + w]; };
  std::vector<float> out;
  std::vector<std::size_t> unknown;  // pieces
  std::vector<double> mean(width);
  for (const std::string& piece : wanted.vocabulary()) {
    std::vector<Index> ids;
    if (const auto same = known.find(piece))
      ids.push_back(*same);
    else if (!has_vectors && !piece.starts_with("##"))
      known.append_word(ids, piece);
    const std::size_t first = out.size();
    out.resize(first + width);
    if (ids.empty() || (ids.front() == WordPiece::unknown_id && !has_vectors)) {
      unknown.push_back(first);
      continue;
    }
    for (const Index id : ids) {
      for (std::size_t w = 0; w < width; ++w) out[first + w] += value(id, w) / static_cast<float>(ids.size());
    }
    for (std::size_t w = 0; w < width; ++w) mean[w] += static_cast<double>(out[first + w]);
  }
  const double known_pieces = static_cast<double>(wanted.size()) - static_cast<double>(unknown.size());
  for (const std::size_t first : unknown) {
    for (std::size_t w = 0; w < width; ++w)
      out[first + w] = has_vectors ? value(WordPiece::unknown_id, w) : static_cast<float>(mean[w] / known_pieces);
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
