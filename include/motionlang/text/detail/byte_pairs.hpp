// SPDX-License-Identifier: MIT
/// Byte-level pair encoding of single words, and a memory of words: what the tokenizers of CLIP and RoBERTa share. Only
/// bodies (*.ipp) include it.
///
/// Source  Sennrich et al. (2016); openai/gpt-2 src/encoder.py
#pragma once

#include <array>          // first symbols
#include <functional>     // order of merges, hash of words
#include <mutex>          // the memory of words
#include <queue>          // merges in their order
#include <span>           // ids
#include <string>         // pieces
#include <string_view>    // words
#include <unordered_map>  // merges
#include <utility>        // merges
#include <vector>         // ids

#include <motionlang/core/shape.hpp>
#include <motionlang/text/detail/byte_symbols.hpp>

MOTIONLANG_NAMESPACE_BEGIN

using BytePairMerges = std::vector<std::pair<std::string, std::string>>;

namespace detail {

/// Byte pair encoding of single words: merges pairs of neighbours in the order of their rank. A constant table.
class BytePairs {
 public:
  /// Throws config_error 107 with the name `source` if a byte has no symbol and `unknown` < 0, or if a merge has a part
  /// or a result that is not a piece.
  BytePairs(const std::vector<std::string>& pieces, const BytePairMerges& merges, const std::string& word_end,
            Index unknown, std::string_view source) {
    std::unordered_map<std::string_view, Index> ids;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (!ids.emplace(pieces[i], static_cast<Index>(i)).second)
        raise<config_error>(107, source, ": piece '", pieces[i], "' is duplicated, the second time as id ", i);
    }
    const auto id_of = [&](const std::string& piece) {
      const auto found = ids.find(piece);
      return found == ids.end() ? Index{-1} : found->second;
    };
    for (std::size_t b = 0; b < 256; ++b) {
      const std::string& symbol = ByteSymbols::get().symbol[b];
      for (const bool last : {false, true}) {
        Index id = id_of(last ? symbol + word_end : symbol);
        if (id < 0) id = unknown;
        if (id < 0) raise<config_error>(107, source, ": no piece for byte ", b, last ? " at the end of a word" : "");
        symbols_[last][b] = id;
      }
    }
    for (std::size_t rank = 0; rank < merges.size(); ++rank) {
      const auto& [left, right] = merges[rank];
      const Index a = id_of(left), b = id_of(right), both = id_of(left + right);
      for (const auto& [piece, id] : {std::pair(left, a), std::pair(right, b), std::pair(left + right, both)}) {
        if (id < 0) raise<config_error>(107, source, ": merge ", rank, ": '", piece, "' is not a piece");
      }
      if (!merges_.emplace(key(a, b), Merge{rank, both}).second)
        raise<config_error>(107, source, ": merge ", rank, ": '", left, "' and '", right, "' are duplicated");
    }
  }

  /// Appends the ids of a word (bytes, not empty). O(n log n).
  void append(std::vector<Index>& out, std::string_view word) const {
    constexpr std::size_t none = static_cast<std::size_t>(-1);
    struct Symbol {
      Index id;  // -1: merged into the one before
      std::size_t previous, next;
    };
    std::vector<Symbol> line(word.size());
    for (std::size_t i = 0; i < word.size(); ++i)
      line[i] = {symbols_[i + 1 == word.size()][static_cast<unsigned char>(word[i])], i - 1, i + 1};
    line.front().previous = line.back().next = none;

    struct Candidate {
      std::size_t rank, at;
      Index left, right, both;
      bool operator>(const Candidate& o) const { return rank != o.rank ? rank > o.rank : at > o.at; }
    };
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> waiting;
    const auto propose = [&](std::size_t at) {
      if (at == none || line[at].next == none) return;
      const Index left = line[at].id, right = line[line[at].next].id;
      if (const auto m = merges_.find(key(left, right)); m != merges_.end())
        waiting.push({m->second.rank, at, left, right, m->second.both});
    };
    for (std::size_t i = 0; i < word.size(); ++i) propose(i);
    // All places of the pair of lowest rank, from left to right, before any new pairs.
    for (std::vector<Candidate> round; !waiting.empty(); round.clear()) {
      for (const std::size_t rank = waiting.top().rank; !waiting.empty() && waiting.top().rank == rank; waiting.pop())
        round.push_back(waiting.top());
      for (const Candidate& c : round) {
        Symbol& left = line[c.at];
        if (left.id != c.left || left.next == none || line[left.next].id != c.right) continue;
        Symbol& right = line[left.next];
        left.id = c.both, right.id = -1;
        left.next = right.next;
        if (left.next != none) line[left.next].previous = c.at;
        propose(left.previous), propose(c.at);
      }
    }
    for (std::size_t i = 0; i != none; i = line[i].next) out.push_back(line[i].id);
  }

 private:
  struct Merge {
    std::size_t rank;
    Index both;
  };
  static std::uint64_t key(Index a, Index b) {
    return static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint64_t>(b);
  }
  std::array<std::array<Index, 256>, 2> symbols_{};  // [at the end of the word][byte]
  std::unordered_map<std::uint64_t, Merge> merges_;
};

/// The ids of words seen so far. It is emptied when full. One thread at a time.
class WordCache {
 public:
  explicit WordCache(std::size_t most) : most_(most) {}
  static constexpr std::size_t longest = 64;  // bytes of a word to keep

  const std::vector<Index>* find(std::string_view word) const {
    const auto found = ids_.find(word);
    return found == ids_.end() ? nullptr : &found->second;
  }
  void keep(std::string_view word, std::span<const Index> ids) {
    if (word.size() > longest || most_ == 0) return;
    if (ids_.size() >= most_) ids_.clear();
    ids_.emplace(std::string(word), std::vector<Index>(ids.begin(), ids.end()));
  }
  std::mutex mutex;  // for the owner

 private:
  struct Hash : std::hash<std::string_view> {
    using is_transparent = void;
  };
  std::size_t most_;
  std::unordered_map<std::string, std::vector<Index>, Hash, std::equal_to<>> ids_;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
