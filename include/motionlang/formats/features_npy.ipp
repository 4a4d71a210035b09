// SPDX-License-Identifier: MIT
// Bodies of features_npy.hpp.
#pragma once

#include <algorithm>  // is_permutation

#include <motionlang/file/npy.hpp>
#include <motionlang/formats/features_npy.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/on_smpl.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY FeatureRows feature_rows(const Motion& motion, const MotionFeatures& features, double fps) {
  if (fps == 0) fps = features.fps;
  // A BVH file has SMPL's joints depth first.
  const auto &names = motion.skeleton.names, &smpl = smpl24_skeleton().names;
  const bool has_smpls = std::is_permutation(names.begin(), names.end(), smpl.begin(), smpl.end());
  const std::vector<double> values = features.from_motion(resample(has_smpls ? on_smpl(motion) : motion, fps));
  return {{values.begin(), values.end()}, std::ssize(values) / features.width, features.width, fps};
}

MOTIONLANG_BODY FeatureRows write_features_npy(const FilePath& path, const Motion& motion,
                                               const MotionFeatures& features, double fps) {
  FeatureRows made = feature_rows(motion, features, fps);
  write_npy(path, NpyArray::of(std::span<const float>(made.values), {made.rows, made.width}));
  return made;
}

MOTIONLANG_NAMESPACE_END
