// SPDX-License-Identifier: MIT
// Bodies of finish_motion.hpp.
#pragma once

#include <motionlang/generate/finish_motion.hpp>
#include <motionlang/kinematics/floor_fix.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>
#include <motionlang/systems/detail/stmc_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY const MotionFeatures& features_of_layout(std::string_view layout, Index width) {
  if (layout != "guoh3dfeats") return motion_features(layout);
  const MotionFeatures& kit = motion_features("kit");
  return width == kit.width ? kit : motion_features("guoh3d");
}

MOTIONLANG_BODY Motion motion_of_features(std::string_view layout, std::span<const double> rows, Index width,
                                          double fps) {
  if (layout == "smplrifke") return detail::published_motion(rows, fps);
  return motion_of_rows(features_of_layout(layout, width), rows, fps);
}

MOTIONLANG_BODY Motion motion_of_features(const MotionFeatures& features, std::span<const float> rows, double fps) {
  const std::vector<double> values(rows.begin(), rows.end());
  return motion_of_rows(features, values, fps);
}

MOTIONLANG_BODY Motion finish_motion(Motion motion, const GenerateOptions& options) {
  if (options.smooth) motion = smooth_motion(motion);
  const auto legs = known_legs(motion.skeleton);
  if (legs.empty()) return motion;
  if (options.fix_floor) motion = stand_on_floor(motion, legs);
  if (options.fix_feet) motion = fix_feet(motion, legs);
  if (options.fix_floor) motion = lift_sunken_feet(motion, legs);
  return motion;
}

MOTIONLANG_NAMESPACE_END
