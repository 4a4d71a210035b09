// SPDX-License-Identifier: MIT
/// AMASS files as they stand, for a body model: all rotation vectors, shape and gender, world Z up. As a Motion on
/// SMPL's bones: amass.hpp.
///
/// Source  Mahmood et al. (ICCV 2019); the keys of the published files
#pragma once

#include <optional>     // a rate that may be missing
#include <span>         // numbers of a shape
#include <string>       // names of files
#include <string_view>  // names of arrays

#include <motionlang/features/amass_sequence.hpp>
#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class NpzArchive;
class ZipArchive;

namespace detail {

/// Throws numeric_error 301.
void require_finite_betas(const std::string& file, std::span<const double> betas);

}  // namespace detail

/// The array that the poses of a sequence begin with: "poses", or "root_orient" or "global_orient" where they are
/// stored in parts. "" where the archive holds no sequence, as the shape.npz files beside them.
std::string_view amass_poses(const NpzArchive& npz);

/// Frames per second of a sequence, as its file says them; it may say none, or impossible ones.
std::optional<double> amass_rate(const NpzArchive& npz);

/// A sequence of SMPL (72 columns), SMPL-H (156, mocap_framerate) or SMPL-X (165, mocap_frame_rate), whose poses
/// may be stored in parts (root_orient, pose_body, ...), also by the names that smplx has for them (global_orient,
/// body_pose, transl, ...). The gender may be a text or an array of one, as in SSM_synced, or that as an object of
/// Python. Of betas for each frame, the first are taken.
/// fps     frames per second of a file that does not say them; 0: it is refused
/// Throws  io_error 401 to 405, 406 if an array is missing (as in the shape.npz files beside the sequences, which hold
///         no motion), 407 if one has another shape, 403 for an impossible frame rate; config_error 102 if the file
///         says another rate; numeric_error 301 if a number of betas is not finite
AmassSequence read_amass_sequence(const FilePath& path, double fps = 0);
/// The same of an archive that is open. Throws all but io_error 401.
AmassSequence amass_sequence(const ZipArchive& zip, double fps = 0);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/amass_sequence.ipp>
#endif
