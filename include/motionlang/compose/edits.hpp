// SPDX-License-Identifier: MIT
/// What an edit of a timeline can change in its motion, step by step. No tensors here.
///
/// A step of STMC makes every frame from the crops that are added and subtracted there, and a crop reads all of its
/// frames. So an edit changes in the first step the frames that are made of other crops than before, in the second one
/// all frames of every crop that reads one of these, and so on: it goes one crop further with every step. It stops
/// where nothing spans a cut (overlap 0), and at the end of the run. As the noise belongs to the frame, all other
/// frames are those of before, bit for bit.
///
/// Source   follows from STMC (Petrovich et al. 2024), algorithm 1; not in the paper
/// Caution  holds for denoisers whose sequences do not depend on their batch mates (see MdmSmplDenoiser)
#pragma once

#include <optional>  // a limit
#include <utility>   // cmp_greater_equal

#include <motionlang/compose/plan.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A crop that is added to a part of a frame, or subtracted from it. Two frames with equal lists are stitched alike.
struct FrameTerm {
  BodyPart part{};
  bool add = true;
  FrameRange crop;
  std::string_view text;
  bool operator==(const FrameTerm&) const = default;
};
/// Of `rows` frames; frames behind the end are made of nothing.
inline std::vector<std::vector<FrameTerm>> frame_terms(const TimelinePlan& plan, Index rows) {
  std::vector<std::vector<FrameTerm>> terms(static_cast<std::size_t>(rows));
  const auto note = [&](const std::vector<Slice>& slices, bool add) {
    for (const Slice& s : slices) {
      const Crop& crop = plan.crops[static_cast<std::size_t>(s.crop)];
      for (Index f = s.to.start; f < s.to.end; ++f)
        terms[static_cast<std::size_t>(f)].push_back({s.part, add, crop.range, plan.text(crop)});
    }
  };
  note(plan.add, true), note(plan.subtract, false);
  return terms;
}

}  // namespace detail

/// The frames that differ between two runs with the same noise, of which the first is recorded, after each step.
class EditSpread {
 public:
  /// The plans of both runs, and how many rows every timeline has in them. The timelines of a batch are compared by
  /// their place in it.
  /// reads   frames that the denoiser reads from the start of a crop; 0: those of the crop
  /// within  frames further than this from the edit are said not to differ, although they would
  EditSpread(const BatchPlan& before, Index rows_before, BatchPlan after, Index rows, Index reads = 0,
             std::optional<Index> within = {})
      : plan_(std::move(after)), rows_(rows), reads_(reads) {
    for (std::size_t m = 0; m < plan_.timelines.size(); ++m) {
      std::vector<char> edited(static_cast<std::size_t>(rows), 1);  // where nothing is recorded
      if (m < before.timelines.size()) {
        const Index longest = std::max(rows, rows_before);
        const auto was = detail::frame_terms(before.timelines[m], longest),
                   is = detail::frame_terms(plan_.timelines[m], longest);
        for (std::size_t f = 0; f < edited.size(); ++f)
          edited[f] = std::cmp_greater_equal(f, rows_before) || was[f] != is[f];
      }
      reachable_.push_back(within ? near(edited, *within) : std::vector<char>(edited.size(), 1));
      differs_.push_back(std::move(edited));
    }
  }

  /// Whether frame f of timeline m differs after this step.
  bool differs(std::size_t m, Index f) const { return differs_[m][static_cast<std::size_t>(f)] != 0; }
  /// Frames of all timelines that differ.
  Index frames() const {
    Index n = 0;
    for (std::size_t m = 0; m < differs_.size(); ++m) n += count(m);
    return n;
  }

  /// Whether every timeline with frames that differ has no others.
  bool everywhere() const {
    for (std::size_t m = 0; m < differs_.size(); ++m) {
      const FrameRange all{0, plan_.timelines[m].frames};
      if (any(m, all) && count(m) < all.size()) return false;
    }
    return true;
  }
  /// Whether `within` has changed anything so far.
  bool limited() const { return limited_; }

  /// The next step. Whether more frames differ after it.
  bool advance() {
    const Index before = frames();
    for (std::size_t m = 0; m < differs_.size(); ++m) {
      const TimelinePlan& plan = plan_.timelines[m];
      std::vector<char> now = differs_[m];
      for_each_slice(plan, [&](const Slice& s) {
        const FrameRange& crop = plan.crops[static_cast<std::size_t>(s.crop)].range;
        if (crop.size() == 0 || !any(m, {crop.start, reads_ > 0 ? std::min(crop.start + reads_, rows_) : crop.end}))
          return;
        for (auto f = static_cast<std::size_t>(s.to.start); f < static_cast<std::size_t>(s.to.end); ++f) {
          now[f] |= reachable_[m][f];
          limited_ |= now[f] == 0;
        }
      });
      differs_[m] = std::move(now);
    }
    return frames() > before;
  }

  /// The plan with only those crops that make frames that differ; the others have no frames and no slices.
  BatchPlan needed() const {
    BatchPlan out = plan_;
    for (std::size_t m = 0; m < differs_.size(); ++m) {
      TimelinePlan& plan = out.timelines[m];
      std::vector<char> used(plan.crops.size());
      for_each_slice(
          plan, [&](const Slice& s) { used[static_cast<std::size_t>(s.crop)] |= static_cast<char>(any(m, s.to)); });
      const auto unused = [&](const Slice& s) { return used[static_cast<std::size_t>(s.crop)] == 0; };
      std::erase_if(plan.add, unused), std::erase_if(plan.subtract, unused);
      for (std::size_t c = 0; c < used.size(); ++c) {
        if (used[c] == 0) plan.crops[c].range.end = plan.crops[c].range.start;
      }
    }
    return out;
  }

 private:
  template <class F>
  static void for_each_slice(const TimelinePlan& plan, F f) {
    for (const Slice& s : plan.add) f(s);
    for (const Slice& s : plan.subtract) f(s);
  }
  Index count(std::size_t m) const {
    return std::count(differs_[m].begin(), differs_[m].begin() + plan_.timelines[m].frames, 1);
  }
  bool any(std::size_t m, const FrameRange& range) const {
    const auto begin = differs_[m].begin();
    return std::find(begin + range.start, begin + range.end, 1) != begin + range.end;
  }
  /// Frames that are at most `within` away from one that is marked.
  static std::vector<char> near(const std::vector<char>& marked, Index within) {
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

  BatchPlan plan_;
  Index rows_ = 0, reads_ = 0;
  bool limited_ = false;
  std::vector<std::vector<char>> differs_, reachable_;  // of every row of every timeline
};

MOTIONLANG_NAMESPACE_END
