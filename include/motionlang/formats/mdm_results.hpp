// SPDX-License-Identifier: MIT
/// Motions that MDM has generated: results.npy as saved by its sample/generate.py, or only the array of positions.
///
///     std::vector<Motion> clips = read_motions_npy("results.npy");
///
///     {'motion': (n, joints, 3, frames), 'text': n texts, 'lengths': (n)}
/// This is a Python object, which is read but not executed. Joints are HumanML3D's 22, SMPL's 24 or KIT's 21. Y is up
/// unless the options say Z. A motion ends at its length. Its name is its number, or the first 160 bytes of its text,
/// so that the name fits into a file's name.
/// Source  Tevet et al., "Human Motion Diffusion Model" (ICLR 2023); GuyTevet/motion-diffusion-model sample/generate.py
#pragma once

#include <span>    // bytes
#include <string>  // names
#include <vector>  // motions

#include <motionlang/formats/motion_npy.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True if a NumPy file may hold motions of MDM. Its header decides, which does not describe objects.
/// Throws  io_error 401 to 405
bool may_be_mdm_motions(const FilePath& path);

/// All motions of a file: MDM's, or the only one of another file (motion_npy.hpp), which gets no name.
/// Throws  io_error 401 to 405, 406 if the object lacks an entry, 407 if something has another shape or type, and as
///         motion_from_array
std::vector<Motion> read_motions_npy(const FilePath& path, const MotionArrayOptions& options = {});
/// The same for a file in memory. Messages contain `name`. Throws all except io_error 401.
std::vector<Motion> motions_of_npy(std::span<const std::byte> bytes, const std::string& name,
                                   const MotionArrayOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/mdm_results.ipp>
#endif
