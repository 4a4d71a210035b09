// SPDX-License-Identifier: MIT
/// The contents of a file of motions as text: frames, rate, extent, the quality of the first motion, and its joints.
#pragma once

#include <string>  // lines

#include <motionlang/file/file_path.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True for a file that describe_motion_file reads. The extension decides, and for .npy and .npz the content, which may
/// also be weights.
bool holds_motions(const FilePath& path);

/// A motion: frames, rate, duration, joints; where its root moves; for SMPL's joints also how feet and floor look.
/// name  begins the first line
std::string describe_motion(const std::string& name, const Motion& motion);

/// The motions of a file: what the file has and they lack, a list if there are several, and the first one. For joint
/// positions in .npy, their extent. Throws what the readers throw.
std::string describe_motion_file(const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/describe_motion.ipp>
#endif
