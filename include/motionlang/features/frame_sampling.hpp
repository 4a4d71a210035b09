// SPDX-License-Identifier: MIT
/// The frames of a clip that the published systems take: other frame rates, parts, windows for training. This is for
/// parity. To resample your own clips use kinematics/motion_tools.hpp.
#pragma once

#include <algorithm>  // min, max, sort
#include <cmath>      // isfinite
#include <span>       // frames
#include <vector>     // indices

#include <motionlang/core/concepts.hpp>
#include <motionlang/core/python_random.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline void require_rates(const char* function, double from, double to) {
  if (!(from > 0 && to > 0 && std::isfinite(from / to) && std::isfinite(to / from)))
    raise<config_error>(101, function, ": ", from, " to ", to, " frames per second");
}

}  // namespace detail

/// TEMOS: frames 0, s, 2s, ..., s = floor(old / new). From 120 frames per second to 12.5 it gives 13.33. Source  TEMOS
/// temos/data/sampling/framerate.py subsample. Throws config_error 101 unless 0 < new <= old.
std::vector<Index> every_nth_frame(Index frames, double old_fps, double new_fps);

/// TEACH and SINC: floor(new / old frames) frames spread evenly from the first to the last, rounded down.
/// Source  TEACH scripts/process_amass.py process_sequence. Throws config_error 101 unless both rates are positive.
std::vector<Index> spread_frames(Index frames, double old_fps, double new_fps);

/// TEMOS: linear interpolation between the frames, (frames, width) -> ((frames - 1) k + 1, width), k = floor(new /
/// old). In double, as published. Throws config_error 101, shape_error 205.
template <Scalar S>
std::vector<double> upsample_linearly(std::span<const S> values, Index width, double old_fps, double new_fps) {
  detail::require_rates("upsample_linearly", old_fps, new_fps);
  const auto factor = static_cast<Index>(new_fps / old_fps);
  if (factor < 1) raise<config_error>(101, "upsample_linearly: from ", old_fps, " down to ", new_fps);
  if (width < 1 || std::ssize(values) % width != 0) {
    raise<shape_error>(205, "upsample_linearly: ", values.size(), " values are not rows of ", width);
  }
  const auto n = static_cast<std::size_t>(width);
  std::vector<double> out;
  for (std::size_t at = 0; at + n < values.size(); at += n) {
    for (Index j = 0; j < factor; ++j) {
      const double t = static_cast<double>(j) / static_cast<double>(factor);
      for (std::size_t i = at; i < at + n; ++i) {
        out.push_back((1 - t) * static_cast<double>(values[i]) + t * static_cast<double>(values[i + n]));
      }
    }
  }
  out.insert(out.end(), values.end() - std::min<Index>(width, std::ssize(values)), values.end());
  return out;
}

/// Consecutive frames. Without frames, `first` is -1.
struct FrameSlice {
  Index first = -1, length = 0;
  bool operator==(const FrameSlice&) const = default;
};
/// TMR: seconds to frames, rounded down and cut at the end of the clip. Source  TMR src/data/motion.py
/// AMASSMotionLoader. Throws config_error 101 for a negative time, or unless the rate is positive.
FrameSlice slice_of_seconds(double start, double end, double fps, Index frames);

struct ActorFrameOptions {
  Index frames = 60;         // to take
  bool random_step = false;  // "random_conseq": the step is random, too
  Index step = 1;            // -1: the largest that fits
  bool scattered = false;    // "random": any frames, in their order; there is no step
};

/// ACTOR: the frames of a training item out of `available` ones. Clips that are too short repeat their last frame. From
/// others, it takes every step-th frame from a random start. The last possible start never occurs, as published.
/// Scattered frames use this generator, too, while the published program uses NumPy's for them.
/// Source  ACTOR src/datasets/dataset.py _get_item_data_index
/// Throws  config_error 101 unless 2 frames or more are asked for, out of 1 or more
std::vector<Index> actor_frames(Index available, const ActorFrameOptions& options, PythonRandom& random);

/// SINC: the frames of a training item. From a longer clip it takes consecutive frames from a random start. The last
/// possible start never occurs, as published. Evaluation takes whole clips (`request` 0) of 15 to 800 frames.
/// Source   SINC sinc/data/sampling
/// Differs  from thesis B.3.1, as published, where clips of 15 to 600 frames are evaluated
struct SincWindow {
  Index request = 300;  // frames to take; 0: all
  Index shortest = 15;
  Index longest = 600;  // used only if all frames are taken

  bool accepts(Index frames) const { return frames >= shortest && (request > 0 || frames <= longest); }
  /// The largest start that may be drawn.
  Index largest_start(Index frames) const { return request > 0 ? std::max<Index>(0, frames - request - 1) : 0; }
  /// below(n) draws a value of 0 ... n - 1.
  template <class F>
  FrameSlice of(Index frames, F below) const {
    const Index length = request > 0 ? std::min(request, frames) : frames;
    return {length < frames ? below(largest_start(frames) + 1) : 0, length};
  }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/features/frame_sampling.ipp>
#endif
