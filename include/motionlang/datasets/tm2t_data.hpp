// SPDX-License-Identifier: MIT
/// The training data of TM2T's tokenizer: its statistics, the windows of the clips, and the frames that become tokens.
/// Also the schedule of teacher forcing.
///
/// Source  TM2T (Guo et al., ECCV 2022), data/dataset.py MotionDataset, networks/trainers.py schedule_tf; appendix B
#pragma once

#include <algorithm>  // min
#include <span>       // lengths
#include <vector>     // windows

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/features/layout.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The deviations by which features are divided. Those of the root's turn, velocity and height, and of the contacts,
/// are reduced, so that these count more.
/// bias   5 in the paper
/// times  as published, the training set and the validation set each divide the same numbers once
/// Throws shape_error 205 unless there are 12 J - 1 values, config_error 101 for a bias that is not positive
template <Scalar S>
std::vector<S> tm2t_deviation(std::vector<S> std, Index joints = 22, double bias = 5, int times = 2) {
  const Guoh3dSlots slots{joints};
  if (joints < 1 || std::ssize(std) != slots.size())
    raise<shape_error>(205, "tm2t_deviation: ", std.size(), " numbers for ", joints, " joints");
  if (!(bias > 0)) raise<config_error>(101, "tm2t_deviation: bias ", bias);
  for (const IndexRange& r : {IndexRange{0, 4}, slots.contacts()}) {
    for (Index i = r.begin; i < r.end; ++i) {
      for (int k = 0; k < times; ++k) std[static_cast<std::size_t>(i)] /= static_cast<S>(bias);
    }
  }
  return std;
}

/// Frames of the longest motion that becomes tokens for training.
inline constexpr Index tm2t_longest = 196;

/// The windows for training the tokenizer: sum (length - window) over the clips that are longer than a window.
struct ClipWindow {
  Index clip = 0, start = 0;
  bool operator==(const ClipWindow&) const = default;
};
/// As published, item 0 is the beginning of the first clip that is at least as long as a window. Item i > 0 has the
/// start i - c - 1 in the clip with c < i <= c + n, where c counts the windows before it. So the last start of each
/// clip is missing. Throws config_error 101 for a window below 1.
std::vector<ClipWindow> tm2t_windows(std::span<const Index> lengths, Index window = 64);

/// The frames that become tokens: whole units from a random start. Throws config_error 101 if there is no unit.
FrameSlice tm2t_token_frames(Index frames, PythonRandom& random, Index unit = 4);

/// The share of batches in which the decoder of text-to-motion gets the true tokens. It changes linearly from `first`,
/// in epoch 0, to `last`, and then stays.
struct TeacherForcing {
  double first = 0.9, last = 0.1;
  Index epochs = 35;

  double operator()(Index epoch) const {
    if (epochs < 1) return last;
    return first + (last - first) * static_cast<double>(std::min(epoch, epochs)) / static_cast<double>(epochs);
  }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/tm2t_data.ipp>
#endif
