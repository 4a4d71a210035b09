// SPDX-License-Identifier: MIT
/// Where each sequence of a packed batch begins: an immutable shared list 0 = o_0 <= o_1 <= ... <= o_n = rows.
#pragma once

#include <initializer_list>  // lengths
#include <memory>            // shared list
#include <span>              // view
#include <vector>            // list

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/core/shape.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// Sequence i has the rows offsets[i] ... offsets[i + 1] - 1. Cheap to copy; whoever keeps a copy keeps the list alive.
class Offsets {
 public:
  Offsets() : Offsets(std::vector<Index>{}) {}
  /// From the lengths of the sequences. Throws shape_error 207 on a negative one.
  explicit Offsets(std::span<const Index> lengths) {
    auto list = std::allocate_shared<List>(PoolAllocator<List>{});
    list->reserve(lengths.size() + 1);
    list->push_back(0);
    for (Index n : lengths) {
      if (n < 0) raise<shape_error>(207, "Offsets: negative length ", n);
      list->push_back(list->back() + n);
    }
    list_ = std::move(list);
  }
  explicit Offsets(const std::vector<Index>& lengths) : Offsets(std::span<const Index>(lengths)) {}
  Offsets(std::initializer_list<Index> lengths) : Offsets(std::span<const Index>(lengths.begin(), lengths.size())) {}
  /// `count` sequences of equal length.
  static Offsets equal(Index count, Index length) {
    return Offsets(std::span<const Index>(PoolVector<Index>(static_cast<std::size_t>(count), length)));
  }

  Index count() const { return static_cast<Index>(list_->size()) - 1; }
  Index rows() const { return list_->back(); }
  Index begin(Index i) const { return (*list_)[static_cast<std::size_t>(i)]; }
  Index end(Index i) const { return (*list_)[static_cast<std::size_t>(i) + 1]; }
  Index length(Index i) const { return end(i) - begin(i); }
  Index longest() const {
    Index n = 0;
    for (Index i = 0; i < count(); ++i) n = length(i) > n ? length(i) : n;
    return n;
  }
  std::span<const Index> list() const { return *list_; }
  bool operator==(const Offsets& o) const { return list_ == o.list_ || *list_ == *o.list_; }

 private:
  using List = PoolVector<Index>;
  std::shared_ptr<const List> list_;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
