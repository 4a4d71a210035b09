// SPDX-License-Identifier: MIT
// Bodies of shared_search.hpp.
#pragma once

#include <motionlang/train/messages.hpp>
#include <motionlang/train/shared_search.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::vector<Neighbour>> SharedSearch::search(std::span<const float> queries,
                                                                         Index k) const {
  if (all_.size() == 1) return part_->search(queries, k);
  std::vector<float> first(queries.begin(), queries.end());
  numbers_of_first(all_, first);  // another kernel may have rounded those of this process in another way
  auto found = part_->search(first, k);
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
  if (all.size() > 1) {
    std::string text;
    for (const ShardEntry& e : shards->list().shards)
      text += concat_text(e.file, ' ', e.checksum, ' ', e.clips, ' ', e.moments, ' ', e.captions, '\n');
    if (const Index other = first_other_text(all, text); other > 0)
      raise<io_error>(403, shards->name(), ": rank ", other, " of ", all.size(),
                      " has other shards than rank 0: all processes need the same files, and no program may write them "
                      "meanwhile");
  }
  const auto in = [&](SearchFor what) {
    return std::make_shared<SharedSearch>(shards->vectors(what, all.rank(), all.size()), all);
  };
  auto clips = in(SearchFor::clips), moments = in(SearchFor::moments), captions = in(SearchFor::captions);
  return MotionSearch(std::move(shards), std::move(clips), std::move(moments), std::move(captions));
}

MOTIONLANG_NAMESPACE_END
