// SPDX-License-Identifier: MIT
/// Clips from NumPy arrays of joint positions or features, as in models and data sets.
///
///     Motion clip = read_motion_npy("new_joint_vecs/012314.npy");   // 263 values in a row: HumanML3D
///
///     (frames, values) features of motion_features.hpp, recognised by the width of a row; not normalised
///     (frames, 24 or 22, 3) joints of SMPL, (frames, 21, 3) of MMM
/// mdm_results.hpp reads files with several motions. motion_from_joints.hpp turns positions into rotations. MMM's
/// joints are in metres or, if the values are large, in KIT's units. With Y up they are mirrored, as in KIT and TEMOS,
/// and are mirrored back, so that "L" is the left.
/// Source  text-to-motion utils/paramUtil.py (KIT's skeleton); TEMOS temos/transforms/rots2joints/smplh.py
#pragma once

#include <string_view>  // names

#include <motionlang/file/file_path.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/kinematics/up_axis.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct NpyArray;

struct MotionArrayOptions {
  double fps = 0;             // 0: as published, 20 or 12.5 frames per second
  UpAxis up = UpAxis::found;  // for positions: where, on average, the head is above the ankles
};

namespace detail {

bool is_joint_count(Index joints);

}  // namespace detail

/// Throws io_error 407 if the array has none of these shapes; shape_error 205, numeric_error 301 for values that are
/// not finite; config_error 101 unless the rate is 0 or positive and finite.
Motion motion_from_array(const NpyArray& array, const MotionArrayOptions& options = {},
                         std::string_view name = "array");

/// Also throws io_error 401 to 405.
Motion read_motion_npy(const FilePath& path, const MotionArrayOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/motion_npy.ipp>
#endif
