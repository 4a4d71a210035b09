// SPDX-License-Identifier: MIT
/// The start of each sequence of a packed batch: an immutable shared list 0 = o_0 <= o_1 <= ... <= o_n = rows.
#pragma once

#include <cstring>           // memcmp
#include <initializer_list>  // lengths
#include <span>              // view
#include <vector>            // lengths

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Sequence i has the rows offsets[i] ... offsets[i + 1] - 1. Cheap to copy; every copy keeps the list alive. A move is
/// a copy, so a moved-from object keeps its list.
class Offsets {
 public:
  Offsets() : Offsets(std::span<const Index>()) {}
  /// From the lengths of the sequences. Throws shape_error 207 on a negative one.
  explicit Offsets(std::span<const Index> lengths)
      : memory_((lengths.size() + 1) * sizeof(Index)), count_(static_cast<Index>(lengths.size())) {
    Index* last = static_cast<Index*>(memory_.data());
    *last = 0;
    for (Index n : lengths) {
      if (n < 0) raise<shape_error>(207, "Offsets: negative length ", n);
      last[1] = *last + n;
      ++last;
    }
  }
  explicit Offsets(const std::vector<Index>& lengths) : Offsets(std::span<const Index>(lengths)) {}
  Offsets(std::initializer_list<Index> lengths) : Offsets(std::span<const Index>(lengths.begin(), lengths.size())) {}
  Offsets(const Offsets&) = default;
  Offsets& operator=(const Offsets&) = default;
  ~Offsets() = default;
  /// `count` sequences of equal length. Throws shape_error 207 if either is negative.
  static Offsets equal(Index count, Index length);

  Index count() const { return count_; }
  Index rows() const { return first()[count_]; }
  Index begin(Index i) const { return first()[i]; }
  Index end(Index i) const { return first()[i + 1]; }
  Index length(Index i) const { return end(i) - begin(i); }
  Index longest() const;
  std::span<const Index> list() const MOTIONLANG_LIFETIMEBOUND {
    return {first(), static_cast<std::size_t>(count_) + 1};
  }
  bool operator==(const Offsets& o) const {
    return count_ == o.count_ &&
           std::memcmp(first(), o.first(), (static_cast<std::size_t>(count_) + 1) * sizeof(Index)) == 0;
  }

 private:
  const Index* first() const { return static_cast<const Index*>(memory_.data()); }
  detail::BufferHandle memory_;
  Index count_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/core/offsets.ipp>
#endif
