// SPDX-License-Identifier: MIT
/// Nearest vectors: the answer of a search, the order of answers, and the common interface of exact and approximate
/// searches.
#pragma once

#include <algorithm>  // heaps, sort
#include <limits>     // infinity
#include <span>       // vectors
#include <vector>     // answers

#include <motionlang/core/concepts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A vector of the gallery and its cosine with the query.
struct Neighbour {
  Index index = 0;
  float score = 0;
  bool operator==(const Neighbour&) const = default;
};
/// True if a precedes b in an answer: the higher score, and of equal scores the lower index.
inline bool is_nearer(const Neighbour& a, const Neighbour& b) {
  return a.score != b.score ? a.score > b.score : a.index < b.index;
}

/// The k nearest of all offered vectors, in any order.
class NearestK {
 public:
  explicit NearestK(Index k) : k_(static_cast<std::size_t>(k)) {}

  void offer(const Neighbour& n) {
    if (heap_.size() < k_) {
      heap_.push_back(n);
    } else if (is_nearer(n, heap_.front())) {
      std::pop_heap(heap_.begin(), heap_.end(), is_nearer);
      heap_.back() = n;
    } else {
      return;
    }
    std::push_heap(heap_.begin(), heap_.end(), is_nearer);
  }
  /// No score below this can enter any more; -infinity while there are fewer than k.
  float least() const { return heap_.size() < k_ ? -std::numeric_limits<float>::infinity() : heap_.front().score; }
  std::span<const Neighbour> unordered() const { return heap_; }
  /// Returns them, nearest first, and becomes empty.
  std::vector<Neighbour> take() {
    std::sort(heap_.begin(), heap_.end(), is_nearer);
    return std::move(heap_);
  }

 private:
  std::size_t k_;
  std::vector<Neighbour> heap_;  // the farthest in front
};

/// A gallery of vectors of length 1 that finds the nearest ones to queries.
/// Scores   are those of exact_cosine in every search: equal vectors have equal scores
/// Order    is_nearer
/// Models   VectorScan (all of the nearest), VectorGraph (most of them, sooner)
class VectorSearch {
 public:
  virtual ~VectorSearch() = default;
  /// The number of vectors, and of values in each.
  virtual Index count() const = 0;
  virtual Index width() const = 0;
  /// queries (n, width), of any length except 0 -> for each its min(k, count) nearest. Throws shape_error 205 unless
  /// they are whole, config_error 101 for k < 0, numeric_error 301 for a query that is not finite, and 302 for one of
  /// length 0.
  virtual std::vector<std::vector<Neighbour>> search(std::span<const float> queries, Index k) const = 0;

 protected:
  VectorSearch() = default;
  VectorSearch(const VectorSearch&) = default;
  VectorSearch& operator=(const VectorSearch&) = default;
};

MOTIONLANG_NAMESPACE_END
