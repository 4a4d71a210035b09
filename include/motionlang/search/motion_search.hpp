// SPDX-License-Identifier: MIT
/// The clips, moments and captions of a MotionIndex that are nearest to a vector of a text or a motion.
///
///     const MotionSearch search(index);
///     for (const MotionHit& hit : search.moments(vector_of("a person waves"), 10)) use(hit);
#pragma once

#include <motionlang/search/index_tables.hpp>
#include <motionlang/search/vector_scan.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct MotionHit {
  Index clip = 0;             // of the index
  double start = 0, end = 0;  // seconds in the file
  float score = 0;            // cosine
  bool operator==(const MotionHit&) const = default;
};

/// The windows of a clip that are indexed: those of moment_windows for each length, without duplicates, in ascending
/// order. A window that is longer than the clip is the whole clip.
std::vector<FrameSlice> indexed_moments(Index frames, const IndexModel& model);

/// Keeps moments that are apart, in the order of their scores. One that overlaps a better one of its clip by an
/// intersection over union above `most_iou` is dropped (greedy non-maximum suppression). At most k are kept.
std::vector<Neighbour> separate_moments(std::span<const Neighbour> best_first,
                                        std::span<const MotionIndex::Moment> moments, double most_iou, Index k);

class MotionSearch {
 public:
  /// The index must outlive the object. `clips` and `moments` search its rows. Without them, scans with `storage`
  /// compare all rows; the storage does not affect the answers.
  explicit MotionSearch(const MotionIndex& index, std::shared_ptr<const VectorSearch> clips = {},
                        std::shared_ptr<const VectorSearch> moments = {}, ScanStorage storage = ScanStorage::float32);

  /// Searches `clips`, `moments` and `captions`, whose vectors have the numbers of these tables.
  MotionSearch(std::shared_ptr<const IndexTables> tables, std::shared_ptr<const VectorSearch> clips,
               std::shared_ptr<const VectorSearch> moments, std::shared_ptr<const VectorSearch> captions)
      : tables_(std::move(tables)),
        clips_(std::move(clips)),
        moments_(std::move(moments)),
        captions_(std::move(captions)) {}

  /// The k nearest clips. Throws what VectorSearch throws.
  std::vector<MotionHit> clips(std::span<const float> query, Index k) const;
  /// The k nearest moments that are apart. Throws config_error 102 if the index has no moments.
  std::vector<MotionHit> moments(std::span<const float> query, Index k, double most_iou = 0.3) const;
  /// The k clips whose captions are nearest, each with the score of its nearest caption.
  std::vector<MotionHit> captions(std::span<const float> query, Index k) const;

 private:
  static std::vector<Neighbour> nearest(const VectorSearch& search, std::span<const float> query, Index k);
  /// `choose` takes the best results and drops some. Later results do not affect earlier choices. Asks for more results
  /// until k are left, or all have been seen.
  template <class F>
  static std::vector<Neighbour> enough(const VectorSearch& search, std::span<const float> query, Index k, F choose) {
    if (k < 0) raise<config_error>(101, "MotionSearch: the ", k, " nearest");
    for (Index asked = 8 * std::min(k, search.count()) + 64;; asked *= 4) {
      const auto best = nearest(search, query, asked);
      auto kept = choose(std::span<const Neighbour>(best));
      if (std::ssize(kept) >= k || std::ssize(best) < asked) return kept;
    }
  }
  MotionHit whole(Index clip, float score) const;

  std::shared_ptr<const IndexTables> tables_;
  std::shared_ptr<const VectorSearch> clips_, moments_, captions_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/motion_search.ipp>
#endif
