// SPDX-License-Identifier: MIT
// Bodies of frame_sampling.hpp.
#pragma once

#include <motionlang/features/frame_sampling.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<Index> every_nth_frame(Index frames, double old_fps, double new_fps) {
  detail::require_rates("every_nth_frame", old_fps, new_fps);
  const auto step = static_cast<Index>(old_fps / new_fps);
  if (step < 1) raise<config_error>(101, "every_nth_frame: from ", old_fps, " up to ", new_fps, " frames per second");
  std::vector<Index> out;
  for (Index f = 0; f < frames; f += step) out.push_back(f);
  return out;
}

MOTIONLANG_BODY std::vector<Index> spread_frames(Index frames, double old_fps, double new_fps) {
  detail::require_rates("spread_frames", old_fps, new_fps);
  const auto count = static_cast<Index>(new_fps / old_fps * static_cast<double>(frames));
  const double step = count > 1 ? static_cast<double>(frames - 1) / static_cast<double>(count - 1) : 0;
  std::vector<Index> out;
  for (Index i = 0; i < count; ++i) {
    out.push_back(i > 0 && i == count - 1 ? frames - 1 : static_cast<Index>(static_cast<double>(i) * step));
  }
  return out;
}

MOTIONLANG_BODY FrameSlice slice_of_seconds(double start, double end, double fps, Index frames) {
  if (!(start >= 0 && end >= 0 && fps > 0 && std::isfinite(start * fps) && std::isfinite(end * fps))) {
    raise<config_error>(101, "slice_of_seconds: ", start, " to ", end, " seconds at ", fps, " frames per second");
  }
  const auto index = [&](double seconds) {
    return static_cast<Index>(std::min(seconds * fps, static_cast<double>(frames)));
  };
  const Index first = index(start), last = index(end);
  return last > first ? FrameSlice{first, last - first} : FrameSlice{};
}

MOTIONLANG_BODY std::vector<Index> actor_frames(Index available, const ActorFrameOptions& options,
                                                PythonRandom& random) {
  const Index k = options.frames, n = available;
  if (k < 2 || n < 1 || options.step == 0 || options.step < -1) {
    raise<config_error>(101, "actor_frames: ", k, " of ", n, " frames, step ", options.step);
  }
  std::vector<Index> out;
  if (k > n) {
    for (Index i = 0; i < k; ++i) out.push_back(std::min(i, n - 1));
    return out;
  }
  if (options.scattered) {
    out = random.sample(n, k);
    std::sort(out.begin(), out.end());
    return out;
  }
  const Index longest = (n - 1) / (k - 1);
  const bool fits = options.step > 0 && options.step * (k - 1) < n;
  const Index step = options.random_step ? static_cast<Index>(random.randint(1, longest))
                     : fits              ? options.step
                                         : longest;
  const Index last = step * (k - 1);
  const auto shift = static_cast<Index>(random.randint(0, std::max<Index>(0, n - last - 2)));
  for (Index i = 0; i < k; ++i) out.push_back(shift + i * step);
  return out;
}

MOTIONLANG_NAMESPACE_END
