// SPDX-License-Identifier: MIT
/// The training data of TM2T's tokenizer: its statistics, the windows of the clips, the frames that become tokens. And
/// how often its decoder is shown the truth.
///
/// Source  TM2T (Guo et al., ECCV 2022), data/dataset.py MotionDataset, networks/trainers.py schedule_tf; appendix B
#pragma once

#include <algorithm>  // min
#include <span>       // lengths
#include <vector>     // windows

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/features/layout.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The deviations by which features are divided: those of turn, velocity and height of the root and of the contacts are
/// made smaller, so that these count more.
/// bias   of the paper: 5
/// times  as published the division is done twice, by the training and by the validation set, on the same numbers
/// Throws shape_error 205 unless there are 12 J - 1 numbers, config_error 101 for a bias that is not positive
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

/// Windows of the tokenizer's training, as many as sum (length - window) over the clips that are longer than it.
struct ClipWindow {
  Index clip = 0, start = 0;
  bool operator==(const ClipWindow&) const = default;
};
/// As published item 0 is the beginning of the first clip that is as long as a window, and item i > 0 is start i - c -
/// 1 of the clip with c < i <= c + n, where c counts the windows before it: the last start of each clip is missing.
/// Throws config_error 101 for a window below 1.
std::vector<ClipWindow> tm2t_windows(std::span<const Index> lengths, Index window = 64);

/// The frames that become tokens: whole units, from a random start on. Throws config_error 101 if there is no unit.
FrameSlice tm2t_token_frames(Index frames, PythonRandom& random, Index unit = 4);

/// Share of the batches in which the decoder of text-to-motion is fed with the true tokens: on a line from `first`, in
/// epoch 0, to `last`, and then so.
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
