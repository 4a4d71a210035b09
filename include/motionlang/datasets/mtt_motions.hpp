// SPDX-License-Identifier: MIT
/// The recorded motions of MTT's texts: which part of which file shows each of them.
///
///     const auto clips = parse_mtt_motions(read_file("motions.txt"), "motions.txt");
///     const std::vector<Vec3<double>> joints = read_mtt_motion("amass_joints", clips[0]);    // (frames, 22), Y up
///
/// Line k of the file, "path # start # end" with times in seconds, belongs to line k of the texts. STMC's own list
/// names sequences of AMASS. A path that begins with "M/" is a clip in a mirror.
/// Source   STMC (Petrovich et al., CVPR workshops 2024) mtt/motions.txt, mtt/load_mtt_texts_motions.py; AMASS is posed
///          with the neutral body without shape, at 20 frames per second
#pragma once

#include <string>       // paths
#include <string_view>  // files
#include <vector>       // joints

#include <motionlang/file/file_path.hpp>
#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A part of a recorded motion.
struct MttClip {
  std::string path;
  double start = 0, end = 0;  // seconds
  bool operator==(const MttClip&) const = default;
};

/// Blank lines are skipped. Throws timeline_error 501 for a line without three fields, 502 for what is not a time, 504
/// for a clip without a frame, 507 for no line.
std::vector<MttClip> parse_mtt_motions(std::string_view file, std::string_view name = "motions");

/// The first 22 joints of a clip, (frames, 22), Y up, metres, 20 frames per second: frames trunc(20 start) up to, not
/// including, trunc(20 end), or the end of the file.
/// The file is the path below the folder, as it is or with .npy, .npz, .bvh or .glb behind it. An .npy file of joints,
/// (frames, 22 or more, 3) at 20 frames per second, is turned to Y up if the body, in the mean, stands along Z. Any
/// other motion is put on SMPL's joints. If there is no file for a path that begins with "M/", the one without it is
/// read and mirrored.
/// Throws io_error 401 if there is no such file, shape_error 203 if it has less than two frames of the clip, and what
/// the readers of motions throw.
std::vector<Vec3<double>> read_mtt_motion(const FilePath& folder, const MttClip& clip);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/mtt_motions.ipp>
#endif
