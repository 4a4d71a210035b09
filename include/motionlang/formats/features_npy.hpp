// SPDX-License-Identifier: MIT
/// Features of motions as .npy files, one row for each frame, as in the systems and their data sets.
///
///     write_features_npy("walk.npy", read_motion("walk.bvh"), motion_features("guoh3d"));
#pragma once

#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Rows of features in single precision.
struct FeatureRows {
  std::vector<float> values{};  // (rows, width), not normalised
  Index rows = 0, width = 0;
  double fps = 0;

  double seconds() const { return static_cast<double>(rows) / fps; }
};

/// The features of a motion on the joints of the features or on SMPL's, at `fps` frames per second (0: the rate of the
/// features). Throws what resample and MotionFeatures::from_motion throw.
FeatureRows feature_rows(const Motion& motion, const MotionFeatures& features, double fps = 0);

/// Writes (rows, width) in float32. Returns what it wrote. Throws io_error 401, and what feature_rows throws.
FeatureRows write_features_npy(const FilePath& path, const Motion& motion, const MotionFeatures& features,
                               double fps = 0);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/features_npy.ipp>
#endif
