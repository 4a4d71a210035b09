// SPDX-License-Identifier: MIT
// Bodies of feature_rows.hpp.
#pragma once

#include <algorithm>  // any_of

#include <motionlang/features/feature_rows.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool has_joints_of(const MotionFeatures& features, const Motion& motion) {
  const Skeleton &own = motion.skeleton, &wanted = features.skeleton();
  return own.names == wanted.names && own.parents == wanted.parents;
}

MOTIONLANG_BODY bool has_joints_of_arrays(const Motion& motion) {
  return std::any_of(all_motion_features.begin(), all_motion_features.end(),
                     [&](const MotionFeatures& features) { return has_joints_of(features, motion); });
}

MOTIONLANG_BODY Motion on_joints_of(const MotionFeatures& features, const Motion& motion) {
  return has_joints_of(features, motion) ? motion : on_smpl(motion);
}

MOTIONLANG_BODY std::vector<double> rows_of_motion(const MotionFeatures& features, const Motion& motion, double fps) {
  return features.from_motion(resample(on_joints_of(features, motion), fps));
}

MOTIONLANG_NAMESPACE_END
