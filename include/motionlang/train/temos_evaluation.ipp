// SPDX-License-Identifier: MIT
// Bodies of temos_evaluation.hpp.
#pragma once

#include <motionlang/train/temos_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY TemosJoints::TemosJoints(const MotionFeatures& f)
    : features(f),
      mmm(f.joints == kit21_skeleton().size()),
      variant(mmm ? temos_rifke()
                  : RifkeVariant{.joints = 22, .z_up = true, .across = {{{2, 1}, {17, 16}}}, .floor = {7, 10, 8, 11}}),
      unit(mmm ? 0.001 : 1) {}

MOTIONLANG_BODY JointFrames TemosJoints::operator()(std::span<const float> rows) const {
  const std::vector<double> values(rows.begin(), rows.end());
  if (!mmm) return detail::turned_up(features.joints_of(values), true);
  JointFrames joints = features.joints_of(values);
  for (auto& p : joints) p = detail::mmm_units_per_metre * Vec3<double>{-p.x, p.y, p.z};
  return joints;
}

MOTIONLANG_BODY std::span<const float> first_text_rows(const DescribedMotion& motion, Index width) {
  const FrameSlice& frames = motion.texts.front().frames;
  return std::span(motion.rows)
      .subspan(static_cast<std::size_t>(frames.first * width), static_cast<std::size_t>(frames.length * width));
}

MOTIONLANG_NAMESPACE_END
