// SPDX-License-Identifier: MIT
/// AMASS files unchanged, for a body model: all rotation vectors, shape and gender, world Z up. amass.hpp gives a
/// Motion on SMPL's bones.
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

/// The array with which the poses of a sequence begin: "poses", or "root_orient" or "global_orient" if they are stored
/// in parts. "" if the archive holds no sequence, like the shape.npz files beside them.
std::string_view amass_poses(const NpzArchive& npz);

/// Frames per second of a sequence, as stated in its file. There may be none, or an impossible value.
std::optional<double> amass_rate(const NpzArchive& npz);

/// A sequence of SMPL (72 columns), SMPL-H (156, mocap_framerate) or SMPL-X (165, mocap_frame_rate). Its poses may be
/// stored in parts (root_orient, pose_body, ...), also under the names of smplx (global_orient, body_pose, transl,
/// ...). The gender may be a text, an array of one (SSM_synced), or that as an object of Python. If there are betas for
/// each frame, the first ones are taken.
/// fps     frames per second of a file that does not state them; 0: refuse such a file
/// Throws  io_error 401 to 405; 406 if an array is missing (as in the shape.npz files beside the sequences, which hold
///         no motion); 407 if one has another shape; 403 for an impossible frame rate. config_error 102 if the file
///         states another rate; numeric_error 301 if a value of betas is not finite
AmassSequence read_amass_sequence(const FilePath& path, double fps = 0);
/// The same for an open archive. Throws all except io_error 401.
AmassSequence amass_sequence(const ZipArchive& zip, double fps = 0);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/amass_sequence.ipp>
#endif
