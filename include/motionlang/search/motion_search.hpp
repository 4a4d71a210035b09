// SPDX-License-Identifier: MIT
/// Clips, moments and captions of a MotionIndex that are nearest to a vector: of a text, of a motion.
///
///     const MotionSearch search(index);
///     for (const MotionHit& hit : search.moments(vector_of("a person waves"), 10)) ...
#pragma once

#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/search/motion_index.hpp>
#include <motionlang/search/vector_scan.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct MotionHit {
  Index clip = 0;             // of the index
  double start = 0, end = 0;  // seconds in the file
  float score = 0;            // cosine
  bool operator==(const MotionHit&) const = default;
};

/// The windows that are indexed of a clip: those of moment_windows for each length, each window once, in ascending
/// order. A window that is longer than the clip is the whole clip.
inline std::vector<FrameSlice> indexed_moments(Index frames, const IndexModel& model) {
  std::vector<FrameSlice> out;
  for (const Index width : model.windows) {
    const auto windows =
        width < frames ? moment_windows(frames, width, model.stride) : std::vector<FrameSlice>{{0, frames}};
    out.insert(out.end(), windows.begin(), windows.end());
  }
  const auto before = [](const FrameSlice& a, const FrameSlice& b) {
    return a.first != b.first ? a.first < b.first : a.length < b.length;
  };
  std::sort(out.begin(), out.end(), before);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Of moments in the order of their scores those that stand apart: one that overlaps a better one of the same clip by
/// an intersection over union above `most_iou` is dropped (greedy non-maximum suppression). At most k are kept.
inline std::vector<Neighbour> separate_moments(std::span<const Neighbour> best_first,
                                               std::span<const MotionIndex::Moment> moments, double most_iou, Index k) {
  std::vector<Neighbour> out;
  for (const Neighbour& n : best_first) {
    if (std::ssize(out) == k) break;
    const auto& mine = moments[static_cast<std::size_t>(n.index)];
    const bool overlaps = std::any_of(out.begin(), out.end(), [&](const Neighbour& better) {
      const auto& other = moments[static_cast<std::size_t>(better.index)];
      return other.clip == mine.clip && temporal_iou(other.frames, mine.frames) > most_iou;
    });
    if (!overlaps) out.push_back(n);
  }
  return out;
}

class MotionSearch {
 public:
  /// The index has to outlive the object. `clips` and `moments` search its rows; unless given, all of them are
  /// compared, by scans with `storage`, which has no influence on the answers.
  explicit MotionSearch(const MotionIndex& index, std::shared_ptr<const VectorSearch> clips = {},
                        std::shared_ptr<const VectorSearch> moments = {}, ScanStorage storage = ScanStorage::float32)
      : index_(index),
        clips_(clips ? std::move(clips) : scan(index.clip_rows(), storage)),
        moments_(moments ? std::move(moments) : scan(index.moment_rows(), storage)),
        captions_(scan(index.caption_rows(), storage)) {}

  /// The k nearest clips. Throws what VectorSearch throws.
  std::vector<MotionHit> clips(std::span<const float> query, Index k) const {
    std::vector<MotionHit> out;
    for (const Neighbour& n : nearest(*clips_, query, k)) out.push_back(whole(n.index, n.score));
    return out;
  }
  /// The k nearest moments that stand apart. Throws config_error 102 if the index has none.
  std::vector<MotionHit> moments(std::span<const float> query, Index k, double most_iou = 0.3) const {
    if (index_.model().windows.empty())
      raise<config_error>(102, "MotionSearch: this index has no moments, only whole clips");
    std::vector<MotionHit> out;
    const auto apart = enough(*moments_, query, k, [&](std::span<const Neighbour> best) {
      return separate_moments(best, index_.moments(), most_iou, k);
    });
    for (const Neighbour& n : apart) {
      const auto& m = index_.moments()[static_cast<std::size_t>(n.index)];
      MotionHit hit = whole(m.clip, n.score);
      const double fps = index_.model().fps, begin = hit.start;
      hit.start = begin + static_cast<double>(m.frames.first) / fps;
      hit.end = std::min(hit.end, begin + static_cast<double>(m.frames.first + m.frames.length) / fps);
      out.push_back(hit);
    }
    return out;
  }
  /// The k clips whose captions are nearest, each with the score of its nearest caption.
  std::vector<MotionHit> captions(std::span<const float> query, Index k) const {
    std::vector<MotionHit> out;
    const auto first_of_clips = [&](std::span<const Neighbour> best) {
      std::vector<Neighbour> kept;
      for (const Neighbour& n : best) {
        const Index clip = index_.caption_clips()[static_cast<std::size_t>(n.index)];
        const bool known =
            std::any_of(kept.begin(), kept.end(), [&](const Neighbour& other) { return other.index == clip; });
        if (!known && std::ssize(kept) < k) kept.push_back({clip, n.score});
      }
      return kept;
    };
    for (const Neighbour& n : enough(*captions_, query, k, first_of_clips)) out.push_back(whole(n.index, n.score));
    return out;
  }

 private:
  std::shared_ptr<const VectorSearch> scan(std::span<const float> rows, ScanStorage storage) const {
    return std::make_shared<VectorScan>(rows, index_.model().width, std::shared_ptr<const void>{}, storage);
  }
  static std::vector<Neighbour> nearest(const VectorSearch& search, std::span<const float> query, Index k) {
    if (std::ssize(query) != search.width())
      raise<shape_error>(204, "MotionSearch: a query of ", counted(query.size(), "number"), ", the index has ",
                         search.width());
    return search.search(query, k)[0];
  }
  /// `choose` takes the best ones and drops some; who is kept does not depend on those that come later. Asks for more
  /// of them until k are left, or all have been seen.
  template <class F>
  static std::vector<Neighbour> enough(const VectorSearch& search, std::span<const float> query, Index k, F choose) {
    if (k < 0) raise<config_error>(101, "MotionSearch: the ", k, " nearest");
    for (Index asked = 8 * std::min(k, search.count()) + 64;; asked *= 4) {
      const auto best = nearest(search, query, asked);
      auto kept = choose(std::span<const Neighbour>(best));
      if (std::ssize(kept) >= k || std::ssize(best) < asked) return kept;
    }
  }
  MotionHit whole(Index clip, float score) const {
    const IndexedClip& c = index_.clips()[static_cast<std::size_t>(clip)];
    return {clip, c.start, c.end, score};
  }

  const MotionIndex& index_;
  std::shared_ptr<const VectorSearch> clips_, moments_, captions_;
};

MOTIONLANG_NAMESPACE_END
