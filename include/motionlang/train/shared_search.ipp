// SPDX-License-Identifier: MIT
// Bodies of shared_search.hpp.
#pragma once

#include <motionlang/train/messages.hpp>
#include <motionlang/train/shared_search.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::vector<Neighbour>> SharedSearch::search(std::span<const float> queries,
                                                                         Index k) const {
  auto found = part_->search(queries, k);
  if (all_.size() == 1) return found;
  MessageWriter mine;
  for (const auto& answer : found) {
    mine.value(std::uint64_t{answer.size()});
    for (const Neighbour& n : answer) mine.value(std::int64_t{n.index}), mine.value(n.score);
  }
  std::vector<NearestK> best(found.size(), NearestK(std::min(k, count())));
  for (const std::string& message : messages_of_all(all_, mine.bytes())) {
    MessageReader in(message);
    for (NearestK& b : best) {
      for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
        const auto index = in.value<std::int64_t>();
        const auto score = in.value<float>();
        if (k > 0) b.offer({static_cast<Index>(index), score});
      }
    }
  }
  for (std::size_t q = 0; q < found.size(); ++q) found[q] = best[q].take();
  return found;
}

MOTIONLANG_BODY MotionSearch open_shared_search(std::shared_ptr<const IndexShards> shards, const AnyCommunicator& all) {
  const auto in = [&](SearchFor what) {
    return std::make_shared<SharedSearch>(shards->vectors(what, all.rank(), all.size()), all);
  };
  auto clips = in(SearchFor::clips), moments = in(SearchFor::moments), captions = in(SearchFor::captions);
  return MotionSearch(std::move(shards), std::move(clips), std::move(moments), std::move(captions));
}

MOTIONLANG_NAMESPACE_END
