// SPDX-License-Identifier: MIT
/// The frames that an edit of a timeline can change, step by step. No tensors here.
///
/// A step of STMC makes every frame from the crops that are added and subtracted there, and a crop reads all of its
/// frames. So in the first step an edit changes the frames that are made of other crops than before. In the second step
/// it changes all frames of every crop that reads one of these, and so on: it spreads by one crop per step. It stops
/// where nothing spans a cut (overlap 0), and at the end of the run. Because the noise belongs to the frame, all other
/// frames stay the same, bit for bit.
///
/// Source   follows from STMC (thesis 6.2.3, figure 6.3 c); not in the thesis
/// Caution  holds for denoisers whose sequences do not depend on the other sequences of a batch (see MdmSmplDenoiser)
#pragma once

#include <optional>  // a limit

#include <motionlang/compose/plan.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The frames that differ after each step between two runs with the same noise. The first run is recorded.
class EditSpread {
 public:
  /// The plans of both runs, and the rows of every timeline in them. The timelines of a batch are compared by their
  /// place in it.
  /// reads   frames that the denoiser reads from the start of a crop; 0: those of the crop
  /// within  frames further than this from the edit count as equal, although they would differ
  EditSpread(const BatchPlan& before, Index rows_before, BatchPlan after, Index rows, Index reads = 0,
             std::optional<Index> within = {});

  /// True if frame f of timeline m differs after this step.
  bool differs(std::size_t m, Index f) const { return differs_[m][static_cast<std::size_t>(f)] != 0; }
  /// Frames of all timelines that differ.
  Index frames() const;

  /// True if in every timeline either all frames differ or none.
  bool everywhere() const;
  /// True if `within` has changed anything so far.
  bool limited() const { return limited_; }

  /// Goes to the next step. Returns true if more frames differ after it.
  bool advance();

  /// The plan with only the crops whose frames differ. The others have no frames and no slices.
  BatchPlan needed() const;

 private:
  template <class F>
  static void for_each_slice(const TimelinePlan& plan, F f) {
    for (const Slice& s : plan.add) f(s);
    for (const Slice& s : plan.subtract) f(s);
  }
  Index count(std::size_t m) const {
    return std::count(differs_[m].begin(), differs_[m].begin() + plan_.timelines[m].frames, 1);
  }
  bool any(std::size_t m, const FrameRange& range) const;
  /// Frames that are at most `within` away from a marked one.
  static std::vector<char> near(const std::vector<char>& marked, Index within);

  BatchPlan plan_;
  Index rows_ = 0, reads_ = 0;
  bool limited_ = false;
  std::vector<std::vector<char>> differs_, reachable_;  // of every row of every timeline
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/edits.ipp>
#endif
