// SPDX-License-Identifier: MIT
// Bodies of word_piece.hpp.
#pragma once

#include <algorithm>      // max
#include <map>            // word counts, in a fixed order
#include <set>            // pieces in order
#include <unordered_map>  // piece -> id

#include <motionlang/core/text_lines.hpp>
#include <motionlang/text/detail/longest_pieces.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The table in which WordPiece looks up pieces.
struct WordPieceIds {
  std::unordered_map<std::string, Index> ids;
  std::size_t longest = 0;  // of all pieces
};

}  // namespace detail

MOTIONLANG_BODY WordPiece::WordPiece(std::vector<std::string> vocabulary, std::string_view source)
    : pieces_(std::move(vocabulary)) {
  if (pieces_.size() < 3 || pieces_[0] != "[CLS]" || pieces_[1] != "[SEP]" || pieces_[2] != "[UNK]") {
    raise<config_error>(107, source, ": a vocabulary of ", pieces_.size(),
                        " pieces does not begin with [CLS], [SEP], [UNK]");
  }
  auto ids = std::make_shared<detail::WordPieceIds>();
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    if (!ids->ids.emplace(pieces_[i], static_cast<Index>(i)).second)
      raise<config_error>(107, source, ": piece '", pieces_[i], "' is duplicated");
    ids->longest = std::max(ids->longest, pieces_[i].size());
  }
  ids_ = std::move(ids);
}

namespace detail {
/// How often texts say each word.
inline std::map<std::string, Index> word_counts(std::span<const std::string> texts) {
  std::map<std::string, Index> counts;
  for (const std::string& t : texts) {
    for (const std::string& w : WordPiece::words(t)) ++counts[w];
  }
  return counts;
}
}  // namespace detail

MOTIONLANG_BODY WordPiece WordPiece::of_words(std::span<const std::string> texts, Index least) {
  std::vector<std::string> vocabulary{"[CLS]", "[SEP]", "[UNK]"};
  std::set<std::string> letters, whole;
  for (const auto& [word, count] : detail::word_counts(texts)) {
    for (std::size_t i = 0; i < word.size(); ++i) letters.insert((i == 0 ? "" : "##") + word.substr(i, 1));
    if (count >= least && word.size() > 1) whole.insert(word);
  }
  vocabulary.insert(vocabulary.end(), letters.begin(), letters.end());
  vocabulary.insert(vocabulary.end(), whole.begin(), whole.end());
  return WordPiece(std::move(vocabulary));
}

MOTIONLANG_BODY WordPiece WordPiece::learn(std::span<const std::string> texts, Index size, Index least) {
  const auto counts = detail::word_counts(texts);
  struct Word {
    std::vector<std::string> pieces;
    Index count;
  };
  std::vector<Word> split;
  std::vector<std::string> vocabulary{"[CLS]", "[SEP]", "[UNK]"};
  std::map<std::string, Index> known;
  for (const auto& [word, count] : counts) {
    Word w{{}, count};
    for (std::size_t i = 0; i < word.size(); ++i) w.pieces.push_back((i == 0 ? "" : "##") + word.substr(i, 1));
    for (const auto& p : w.pieces) known[p] += count;
    split.push_back(std::move(w));
  }
  for (const auto& [piece, count] : known) vocabulary.push_back(piece);
  while (static_cast<Index>(vocabulary.size()) < size) {
    std::map<std::string, Index> single;
    std::map<std::pair<std::string, std::string>, Index> pairs;
    for (const Word& w : split) {
      for (std::size_t i = 0; i < w.pieces.size(); ++i) {
        single[w.pieces[i]] += w.count;
        if (i + 1 < w.pieces.size()) pairs[{w.pieces[i], w.pieces[i + 1]}] += w.count;
      }
    }
    double best_score = 0;
    std::pair<std::string, std::string> best;
    for (const auto& [pair, count] : pairs) {
      if (count < least) continue;
      const double score = static_cast<double>(count) /
                           (static_cast<double>(single[pair.first]) * static_cast<double>(single[pair.second]));
      if (score > best_score) best_score = score, best = pair;
    }
    if (best_score == 0) break;
    const std::string merged = best.first + best.second.substr(2);
    for (Word& w : split) {
      for (std::size_t i = 0; i + 1 < w.pieces.size(); ++i) {
        if (w.pieces[i] != best.first || w.pieces[i + 1] != best.second) continue;
        w.pieces[i] = merged;
        w.pieces.erase(w.pieces.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      }
    }
    vocabulary.push_back(merged);
  }
  return WordPiece(std::move(vocabulary));
}

MOTIONLANG_BODY std::vector<Index> WordPiece::encode(std::string_view text, Index longest) const {
  if (longest < 2) raise<config_error>(101, "WordPiece: at most ", longest, " ids, the frame has 2");
  std::vector<Index> ids{begin_id};
  for (const std::string& w : words(text)) append_word(ids, w);
  if (static_cast<Index>(ids.size()) > longest - 1) ids.resize(static_cast<std::size_t>(longest - 1));
  ids.push_back(end_id);
  return ids;
}

MOTIONLANG_BODY std::vector<std::string> WordPiece::words(std::string_view text) {
  std::vector<std::string> out;
  bool inside = false;
  for (char c : text) {
    c = detail::lower(c);
    const bool part = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (part && !inside) out.emplace_back();
    if (part) out.back() += c;
    inside = part;
  }
  return out;
}

MOTIONLANG_BODY std::optional<Index> WordPiece::find(const std::string& word) const {
  if (ids_ == nullptr) return std::nullopt;
  const auto found = ids_->ids.find(word);
  return found == ids_->ids.end() ? std::nullopt : std::optional(found->second);
}

MOTIONLANG_BODY void WordPiece::append_word(std::vector<Index>& ids, const std::string& word) const {
  const std::size_t longest = ids_ == nullptr ? 0 : ids_->longest;
  detail::append_longest_pieces(ids, word, longest, unknown_id, [&](std::string_view part, bool first) {
    const auto found = ids_->ids.find((first ? "" : "##") + std::string(part));
    return found == ids_->ids.end() ? Index{-1} : found->second;
  });
}

MOTIONLANG_NAMESPACE_END
