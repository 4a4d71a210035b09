// SPDX-License-Identifier: MIT
/// A small word-piece tokenizer whose vocabulary is learnt from the captions of a training set.
///
/// For plain captions: ASCII letters are lowered, everything that is neither letter nor digit separates words. The
/// tokenizers of BERT and CLIP, with their Unicode rules, are other headers.
#pragma once

#include <algorithm>      // max
#include <map>            // word counts, in a fixed order
#include <span>           // texts
#include <string>         // pieces
#include <string_view>    // lookups
#include <unordered_map>  // piece -> id
#include <vector>         // pieces

#include <motionlang/core/shape.hpp>
#include <motionlang/core/text_lines.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Splits a word from the left into the longest known pieces and appends their ids; `unknown` alone if that fails.
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

/// Pieces that continue a word begin with "##". The first three ids are fixed.
class WordPiece {
 public:
  static constexpr Index begin_id = 0, end_id = 1, unknown_id = 2;

  WordPiece() = default;
  /// Throws config_error 107 unless the vocabulary begins with [CLS], [SEP], [UNK] and has no piece twice; `source`
  /// stands in messages.
  explicit WordPiece(std::vector<std::string> vocabulary, std::string_view source = "WordPiece")
      : pieces_(std::move(vocabulary)) {
    if (pieces_.size() < 3 || pieces_[0] != "[CLS]" || pieces_[1] != "[SEP]" || pieces_[2] != "[UNK]") {
      raise<config_error>(107, source, ": a vocabulary of ", pieces_.size(),
                          " pieces does not begin with [CLS], [SEP], [UNK]");
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!ids_.emplace(pieces_[i], static_cast<Index>(i)).second)
        raise<config_error>(107, source, ": piece '", pieces_[i], "' stands twice");
      longest_ = std::max(longest_, pieces_[i].size());
    }
  }

  /// Learns a vocabulary: all letters, then the merges with the largest count(ab) / (count(a) count(b)) that occur at
  /// least `least` times, until `size` pieces; ties go to the alphabetically first.
  /// Source  the WordPiece criterion as described for BERT (Schuster and Nakajima 2012)
  static WordPiece learn(std::span<const std::string> texts, Index size, Index least = 2) {
    std::map<std::string, Index> counts;
    for (const std::string& t : texts) {
      for (const std::string& w : words(t)) ++counts[w];
    }
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

  const std::vector<std::string>& vocabulary() const { return pieces_; }
  Index size() const { return static_cast<Index>(pieces_.size()); }

  /// [CLS] pieces [SEP], at most `longest` ids; every word is split greedily into the longest known pieces, a word that
  /// cannot be split is [UNK]. Throws config_error 101 if `longest` leaves no room for [CLS] and [SEP].
  std::vector<Index> encode(std::string_view text, Index longest = 64) const {
    if (longest < 2) raise<config_error>(101, "WordPiece: at most ", longest, " ids, the frame has 2");
    std::vector<Index> ids{begin_id};
    for (const std::string& w : words(text)) append_word(ids, w);
    if (static_cast<Index>(ids.size()) > longest - 1) ids.resize(static_cast<std::size_t>(longest - 1));
    ids.push_back(end_id);
    return ids;
  }

  /// Lower-case runs of letters and digits.
  static std::vector<std::string> words(std::string_view text) {
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

 private:
  void append_word(std::vector<Index>& ids, const std::string& word) const {
    detail::append_longest_pieces(ids, word, longest_, unknown_id, [&](std::string_view part, bool first) {
      const auto found = ids_.find((first ? "" : "##") + std::string(part));
      return found == ids_.end() ? Index{-1} : found->second;
    });
  }

  std::vector<std::string> pieces_;
  std::unordered_map<std::string, Index> ids_;
  std::size_t longest_ = 0;
};

MOTIONLANG_NAMESPACE_END
