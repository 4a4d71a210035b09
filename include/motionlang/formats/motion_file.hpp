// SPDX-License-Identifier: MIT
/// Reads and writes motions in every supported format, chosen by the extension of the name.
///
///     write_motion("dance.glb", read_motion("dance.bvh"));
///     for (const Motion& m : read_motions("results.npy")) write_motion(m.name + ".bvh", m);
///
/// Reads   .bvh (a motion for each ROOT), .amc with its .asf, .npz (AMASS, smplx), .npy (joints, features, or all
///         motions of MDM's results.npy), .glb, .gltf, .vrm and .vrma (a motion for each animation)
/// Writes  .bvh, .glb, .vrma, .npz (AMASS), .npy (joint positions, Z up). Pages and pictures: view/view_file.hpp
///
/// Each format has a header of its own with all of its options. These functions take the options that the formats
/// share.
#pragma once

#include <cstddef>   // byte
#include <optional>  // frames per second
#include <set>       // names that are taken
#include <span>      // motions
#include <string>    // names
#include <vector>    // motions

#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/motion_npy.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A format ignores options of other formats.
struct MotionReadOptions {
  double scale = 0.01;          // metres per unit of a BVH file
  std::optional<double> fps{};  // for .glb, .gltf, .vrm and .vrma, whose keys have times of their own; none: rate()
  double rate = 0;              // of an .npy, .amc or .npz file that has none; 0: as published, 120 for AMC
  UpAxis up = UpAxis::found;    // for all but .npz files, turned to +Y; `found`: for an .npy file with positions only
  std::string asf{};            // skeleton of an AMC file; "": asf_beside
  std::string joints{};         // skeleton table that maps motions to SMPL's joints; "": they stay on their own
  bool drop_lead_in = false;    // leave out a T-pose that an exporter inserted (detect_t_pose_lead_in)
};

struct MotionWriteOptions {
  double scale = 100;  // units per metre of a BVH file
  AmassBody body{};    // the person, for the metadata of an .npz file
};

/// The extension of a name in lower case, with the dot: ".bvh". "" if there is none.
std::string file_kind(const FilePath& path);

/// True if a file holds glTF, with any number of animations: .glb, .gltf, .vrm, .vrma.
bool is_gltf(const FilePath& path);
/// True if files of this kind usually hold motions: .bvh, .amc, .npz, .npy, .glb, .vrma. (read_motions also reads .vrm
/// and .gltf, which are mostly avatars and scenes.)
bool is_motion_file(const FilePath& path);
/// True if write_motion writes this kind: .bvh, .glb, .vrma, .npz, .npy.
bool is_written_motion(const FilePath& path);

/// The skeleton beside an AMC file: that of its subject, as in CMU's folders (01.asf beside 01_02.amc), otherwise the
/// only one in the folder. The file need not exist.
FilePath asf_beside(const FilePath& amc);

/// The motions of a file. Each has a unique name; a single motion has the name of the file.
/// notes   gets a line for each thing in the file that the motions lack: bones that stretch, a T-pose in front
/// Throws  config_error 103 for another extension and for a GLB file without animation, io_error 401 for a file that
///         cannot be opened and for an AMC file whose skeleton is not found, and what the readers of the formats throw
std::vector<Motion> read_motions(const FilePath& path, const MotionReadOptions& options = {},
                                 std::string* notes = nullptr);
/// The only motion of a file. Throws config_error 102 if it has several, and what read_motions throws.
Motion read_motion(const FilePath& path, const MotionReadOptions& options = {}, std::string* notes = nullptr);
/// The motions of a file in memory. The extension of `name` decides the format. The skeleton of an AMC file and a table
/// of joints are still read from the files that the options name.
std::vector<Motion> parse_motions(std::span<const std::byte> bytes, const FilePath& name,
                                  const MotionReadOptions& options = {}, std::string* notes = nullptr);

/// Writes a motion. The readers of AMASS and joint arrays know only some skeletons, so a motion on another one is first
/// retargeted to SMPL's joints.
/// Throws  config_error 103 for another extension, io_error 401, and what the writers of the formats throw
void write_motion(const FilePath& path, const Motion& motion, const MotionWriteOptions& options = {});
/// The contents of such a file. `kind` is the extension, ".bvh", or a name that ends in it.
std::vector<std::byte> motion_bytes(const FilePath& kind, const Motion& motion, const MotionWriteOptions& options = {});

/// A name that is not in `taken`: a second "walk" becomes "walk_2". Adds it to `taken`.
std::string unique_name(const std::string& name, std::set<std::string>& taken);

namespace detail {

/// The extension of a name, or the name itself if it is an extension: ".bvh" for "walk.BVH" and for ".bvh".
std::string wanted_kind(const FilePath& kind);
/// The end of a message about an unsupported file, if a converter is known.
const char* about_fbx(std::string_view kind);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/motion_file.ipp>
#endif
