// SPDX-License-Identifier: MIT
// Bodies of motion_search.hpp.
#pragma once

#include <algorithm>  // sort, any_of

#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/search/motion_search.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<FrameSlice> indexed_moments(Index frames, const IndexModel& model) {
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

namespace detail {

/// moment_of  the moment with a number
template <class F>
std::vector<Neighbour> separate_moments(std::span<const Neighbour> best_first, const F& moment_of, double most_iou,
                                        Index k) {
  std::vector<Neighbour> out;
  std::vector<MotionIndex::Moment> kept;
  for (const Neighbour& n : best_first) {
    if (std::ssize(out) == k) break;
    const MotionIndex::Moment mine = moment_of(n.index);
    const bool overlaps = std::any_of(kept.begin(), kept.end(), [&](const MotionIndex::Moment& other) {
      return other.clip == mine.clip && temporal_iou(other.frames, mine.frames) > most_iou;
    });
    if (overlaps) continue;
    out.push_back(n);
    kept.push_back(mine);
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<Neighbour> separate_moments(std::span<const Neighbour> best_first,
                                                        std::span<const MotionIndex::Moment> moments, double most_iou,
                                                        Index k) {
  return detail::separate_moments(
      best_first, [&](Index i) { return moments[static_cast<std::size_t>(i)]; }, most_iou, k);
}

MOTIONLANG_BODY MotionSearch::MotionSearch(const MotionIndex& index, std::shared_ptr<const VectorSearch> clips,
                                           std::shared_ptr<const VectorSearch> moments, ScanStorage storage)
    : tables_(std::make_shared<TablesOfIndex>(index)), clips_(std::move(clips)), moments_(std::move(moments)) {
  const auto scan = [&](std::span<const float> rows) {
    return std::make_shared<VectorScan>(rows, index.model().width, std::shared_ptr<const void>{}, storage);
  };
  if (!clips_) clips_ = scan(index.clip_rows());
  if (!moments_) moments_ = scan(index.moment_rows());
  captions_ = scan(index.caption_rows());
}

MOTIONLANG_BODY std::vector<MotionHit> MotionSearch::clips(std::span<const float> query, Index k) const {
  std::vector<MotionHit> out;
  for (const Neighbour& n : nearest(*clips_, query, k)) out.push_back(whole(n.index, n.score));
  return out;
}

MOTIONLANG_BODY std::vector<MotionHit> MotionSearch::moments(std::span<const float> query, Index k,
                                                             double most_iou) const {
  if (tables_->model().windows.empty())
    raise<config_error>(102, "MotionSearch: this index has no moments, only whole clips");
  std::vector<MotionHit> out;
  const auto apart = enough(*moments_, query, k, [&](std::span<const Neighbour> best) {
    return detail::separate_moments(
        best, [&](Index i) { return tables_->moment(i); }, most_iou, k);
  });
  for (const Neighbour& n : apart) {
    const MotionIndex::Moment m = tables_->moment(n.index);
    MotionHit hit = whole(m.clip, n.score);
    const double fps = tables_->model().fps, begin = hit.start;
    hit.start = begin + static_cast<double>(m.frames.first) / fps;
    hit.end = std::min(hit.end, begin + static_cast<double>(m.frames.first + m.frames.length) / fps);
    out.push_back(hit);
  }
  return out;
}

MOTIONLANG_BODY std::vector<MotionHit> MotionSearch::captions(std::span<const float> query, Index k) const {
  std::vector<MotionHit> out;
  const auto first_of_clips = [&](std::span<const Neighbour> best) {
    std::vector<Neighbour> kept;
    for (const Neighbour& n : best) {
      const Index clip = tables_->clip_of_caption(n.index);
      const bool known =
          std::any_of(kept.begin(), kept.end(), [&](const Neighbour& other) { return other.index == clip; });
      if (!known && std::ssize(kept) < k) kept.push_back({clip, n.score});
    }
    return kept;
  };
  for (const Neighbour& n : enough(*captions_, query, k, first_of_clips)) out.push_back(whole(n.index, n.score));
  return out;
}

MOTIONLANG_BODY std::vector<Neighbour> MotionSearch::nearest(const VectorSearch& search, std::span<const float> query,
                                                             Index k) {
  if (std::ssize(query) != search.width())
    raise<shape_error>(204, "MotionSearch: a query of ", counted(query.size(), "number"), ", the index has ",
                       search.width());
  return search.search(query, k)[0];
}

MOTIONLANG_BODY MotionHit MotionSearch::whole(Index clip, float score) const {
  const IndexedClip c = tables_->clip(clip);
  return {clip, c.start, c.end, score};
}

MOTIONLANG_NAMESPACE_END
