// SPDX-License-Identifier: MIT
/// A motion as a clip of a data set in HumanML3D's or KIT-ML's form.
///
///     add_humanml3d_clip("my_data", "walk", read_motion("walk.bvh"), *find_data_set_form("guoh3d"));
#pragma once

#include <string>  // ids

#include <motionlang/datasets/data_set_form.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The clip that was written.
struct AddedClip {
  Index frames = 0;
  double fps = 0;
  std::size_t captions = 0;  // captions of this id that the data set already has
};

/// A clip without captions from rows of features, (frames, 12 J - 1), and the joints that they stand for. Throws
/// shape_error 205.
HumanMl3dClip humanml3d_clip_of_rows(const std::string& id, std::vector<float> rows, const HumanMl3dForm& form = {});

/// Writes features and joints of a motion, on the joints of the features or on SMPL's, and adds its id to all.txt.
/// Existing captions of this id stay.
/// fps      frames per second of the clip; 0: those of the features
/// replace  replaces another motion of this id
/// Throws   config_error 102 if the clips of the data set have the other form, or if another motion has this id and
///          `replace` is not set; what MotionFeatures::from_motion and write_humanml3d_clip throw
AddedClip add_humanml3d_clip(const std::filesystem::path& folder, const std::string& id, const Motion& motion,
                             const DataSetForm& form, double fps = 0, bool replace = false);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/humanml3d_clip.ipp>
#endif
