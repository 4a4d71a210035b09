// SPDX-License-Identifier: MIT
// Bodies of guo_motions.hpp.
#pragma once

#include <algorithm>  // min
#include <cmath>      // ceil

#include <motionlang/features/feature_rows.hpp>
#include <motionlang/generate/guo_motions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::vector<double>> guo_made(const MotionModel& model, Index width,
                                                          std::span<const GuoWanted> wanted, std::uint64_t seed,
                                                          const GuoMakingOptions& options) {
  if (width != 263 && width != 251)
    raise<config_error>(103, "guo_made: features of ", counted(width, "number"), ", expected 263 or 251");
  const MotionFeatures& features = motion_features(width == 251 ? "kit" : "guoh3d");
  std::vector<Timeline> timelines;
  for (const GuoWanted& w : wanted) {
    // One frame more, because a row needs the frame after it.
    const auto frames =
        static_cast<Index>(std::ceil(static_cast<double>(w.frames) / features.fps * model.fps() - 1e-9)) + 1;
    const Index most = model.longest_crop();
    timelines.push_back(whole_body_timeline(w.caption, most > 0 ? std::min(most, frames) : frames));
  }
  std::vector<std::vector<double>> out;
  GenerateOptions how;
  how.seed = seed;
  how.communicator = options.communicator;
  how.cut_texts = how.smooth = how.fix_feet = how.fix_floor = false;
  if (model.steps() > 0) how.steps = options.steps, how.guidance = options.guidance;
  for (const Motion& motion : generate_motions(model, timelines, how)) {
    auto rows = rows_of_motion(features, motion, features.fps);
    const Index longest = wanted[out.size()].frames;
    rows.resize(std::min(rows.size(), static_cast<std::size_t>(longest * width)));
    out.push_back(std::move(rows));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
