// SPDX-License-Identifier: MIT
// Bodies of edits.hpp.
#pragma once

#include <utility>  // cmp_greater_equal

#include <motionlang/compose/edits.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A crop to add to a part of a frame, or to subtract from it. Two frames with equal lists are stitched alike.
struct FrameTerm {
  BodyPart part{};
  bool add = true;
  FrameRange crop;
  std::string_view text;
  FrameRange own;  // the frames of the text, in which a crop may follow a remembered motion
  bool operator==(const FrameTerm&) const = default;
};

/// For `rows` frames; frames after the end depend on nothing.
inline std::vector<std::vector<FrameTerm>> frame_terms(const TimelinePlan& plan, Index rows) {
  std::vector<std::vector<FrameTerm>> terms(static_cast<std::size_t>(rows));
  const auto note = [&](const std::vector<Slice>& slices, bool add) {
    for (const Slice& s : slices) {
      const Crop& crop = plan.crops[static_cast<std::size_t>(s.crop)];
      FrameRange own{};
      if (!crop.is_transition()) {
        const Interval& text = plan.timeline.intervals[static_cast<std::size_t>(crop.interval)];
        own = {text.start, text.end};
      }
      for (Index f = s.to.start; f < s.to.end; ++f)
        terms[static_cast<std::size_t>(f)].push_back({s.part, add, crop.range, plan.text(crop), own});
    }
  };
  note(plan.add, true), note(plan.subtract, false);
  return terms;
}

}  // namespace detail

MOTIONLANG_BODY EditSpread::EditSpread(const BatchPlan& before, Index rows_before, BatchPlan after, Index rows,
                                       Index reads, std::optional<Index> within)
    : plan_(std::move(after)), rows_(rows), reads_(reads) {
  for (std::size_t m = 0; m < plan_.timelines.size(); ++m) {
    std::vector<char> edited(static_cast<std::size_t>(rows), 1);  // true if nothing is recorded, or for another body
    if (m < before.timelines.size() && before.timelines[m].timeline.body == plan_.timelines[m].timeline.body) {
      const Index longest = std::max(rows, rows_before);
      const auto was = detail::frame_terms(before.timelines[m], longest),
                 is = detail::frame_terms(plan_.timelines[m], longest);
      for (std::size_t f = 0; f < edited.size(); ++f)
        edited[f] = std::cmp_greater_equal(f, rows_before) || was[f] != is[f] ? 1 : 0;
    }
    reachable_.push_back(within ? near(edited, *within) : std::vector<char>(edited.size(), 1));
    differs_.push_back(std::move(edited));
  }
}

MOTIONLANG_BODY Index EditSpread::frames() const {
  Index n = 0;
  for (std::size_t m = 0; m < differs_.size(); ++m) n += count(m);
  return n;
}

MOTIONLANG_BODY bool EditSpread::everywhere() const {
  for (std::size_t m = 0; m < differs_.size(); ++m) {
    const FrameRange all{0, plan_.timelines[m].frames};
    if (any(m, all) && count(m) < all.size()) return false;
  }
  return true;
}

MOTIONLANG_BODY bool EditSpread::advance() {
  const Index before = frames();
  for (std::size_t m = 0; m < differs_.size(); ++m) {
    const TimelinePlan& plan = plan_.timelines[m];
    std::vector<char> now = differs_[m];
    for_each_slice(plan, [&](const Slice& s) {
      const FrameRange& crop = plan.crops[static_cast<std::size_t>(s.crop)].range;
      if (crop.size() == 0 || !any(m, {crop.start, reads_ > 0 ? std::min(crop.start + reads_, rows_) : crop.end}))
        return;
      for (auto f = static_cast<std::size_t>(s.to.start); f < static_cast<std::size_t>(s.to.end); ++f) {
        if (reachable_[m][f] != 0) now[f] = 1;
        limited_ |= now[f] == 0;
      }
    });
    differs_[m] = std::move(now);
  }
  return frames() > before;
}

MOTIONLANG_BODY BatchPlan EditSpread::needed() const {
  BatchPlan out = plan_;
  for (std::size_t m = 0; m < differs_.size(); ++m) {
    TimelinePlan& plan = out.timelines[m];
    std::vector<char> used(plan.crops.size());
    for_each_slice(plan, [&](const Slice& s) {
      if (any(m, s.to)) used[static_cast<std::size_t>(s.crop)] = 1;
    });
    const auto unused = [&](const Slice& s) { return used[static_cast<std::size_t>(s.crop)] == 0; };
    std::erase_if(plan.add, unused), std::erase_if(plan.subtract, unused);
    for (std::size_t c = 0; c < used.size(); ++c) {
      if (used[c] == 0) plan.crops[c].range.end = plan.crops[c].range.start;
    }
  }
  return out;
}

MOTIONLANG_BODY bool EditSpread::any(std::size_t m, const FrameRange& range) const {
  const auto begin = differs_[m].begin();
  return std::find(begin + range.start, begin + range.end, 1) != begin + range.end;
}

MOTIONLANG_BODY std::vector<char> EditSpread::near(const std::vector<char>& marked, Index within) {
  std::vector<char> out(marked.size());
  const auto sweep = [&](auto first, auto last, auto to) {
    for (Index left = -1; first != last; ++first, ++to) {
      left = *first != 0 ? within : left - 1;
      if (left >= 0) *to = 1;
    }
  };
  sweep(marked.begin(), marked.end(), out.begin());
  sweep(marked.rbegin(), marked.rend(), out.rbegin());
  return out;
}

MOTIONLANG_NAMESPACE_END
