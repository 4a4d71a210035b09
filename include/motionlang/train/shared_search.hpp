// SPDX-License-Identifier: MIT
/// A search whose shards several processes share. Each searches its own, and the nearest of all are the answer, as in
/// one process.
///
///     const auto shards = IndexShards::open("moves.shards");
///     const MotionSearch search = open_shared_search(shards, all);           // in every process
///     search.moments(query, 10);                                             // in every process, with the same query
#pragma once

#include <memory>   // searches
#include <utility>  // move

#include <motionlang/search/index_shards.hpp>
#include <motionlang/train/communicator.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class SharedSearch : public VectorSearch {
 public:
  /// part  finds the nearest of this process's vectors, with their numbers among all
  /// all   must outlive the object
  SharedSearch(std::shared_ptr<const VectorSearch> part, const AnyCommunicator& all)
      : part_(std::move(part)), all_(all) {}

  Index count() const override { return part_->count(); }
  Index width() const override { return part_->width(); }
  /// All processes call it with as many queries and the same k. They search those of rank 0, and get the same answer.
  std::vector<std::vector<Neighbour>> search(std::span<const float> queries, Index k) const override;

 private:
  std::shared_ptr<const VectorSearch> part_;
  AnyCommunicator all_;
};

/// The search of a process: it has every shard whose number is its rank, modulo the number of processes. All call it.
/// Throws io_error 403 in all processes if the shards of one are not those of rank 0.
MotionSearch open_shared_search(std::shared_ptr<const IndexShards> shards, const AnyCommunicator& all);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/shared_search.ipp>
#endif
