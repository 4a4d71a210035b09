// SPDX-License-Identifier: MIT
/// Raw KIT Motion-Language, as TEMOS reads it: texts, and joint positions at 100 frames per second.
///
///     <id>_annotations.json   ["A person waves.", ...]
///     <id>_meta.json          {"nb_annotations": 1, ...}
///    <id>_fke.csv            a header line; then an index and x, y, z of MMM's 21 joints on each line, millimetres
///
/// kitml_amass_path.json of TEMOS names the same recordings in AMASS.
///
/// Source  Plappert et al. (2016); the csv files from the preprocessing of Ghosh et al., which TEMOS
///         reads; thesis 4.3.1
#pragma once

#include <filesystem>   // folders
#include <string>       // ids
#include <string_view>  // texts
#include <utility>      // move
#include <vector>       // joints

#include <motionlang/core/shape.hpp>
#include <motionlang/file/file_path.hpp>
#include <motionlang/file/json_members.hpp>
#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct KitRecording {
  static constexpr double fps = 100;
  static constexpr std::size_t joint_count = 21;
  std::string id;
  std::vector<std::string> annotations;
  std::vector<Vec3<double>> joints;  // (frames, 21), joint fastest; in the units and axes of the file

  Index frames() const { return static_cast<Index>(joints.size() / joint_count); }
};

/// The positions in the text of a _fke.csv. Throws io_error 403, with the line, unless every line has 64 numbers. The
/// first is an index, which is only checked.
std::vector<Vec3<double>> parse_kit_joints(std::string_view text, std::string_view name = "fke.csv");

/// True for a folder that has a _meta.json.
bool is_kit_recordings(const std::filesystem::path& folder);

/// The file kitml_amass_path.json: {"00001": {"path": "3/walk_poses.npz", "identifier": "kit"}, ...}.
class KitAmassPaths {
 public:
  /// Throws what JsonMembers::open throws.
  explicit KitAmassPaths(const FilePath& path) : members_(JsonMembers::open(path)) {}

  /// The file of a recording in the folder of AMASS: below KIT, or below CMU or else EKUT. It may have the name of a
  /// later release (_stageii.npz). "" if the list or the folder lacks it. Throws io_error 403 for a path that leads
  /// out of the folder or another collection, config_error 107.
  std::filesystem::path file(const std::string& id, const std::filesystem::path& amass) const;
  bool has(const std::string& id) const { return members_.has(id); }

 private:
  JsonMembers members_;
};

/// A folder that is open for reading. Nothing is kept in memory: every call reads its files.
class KitRecordings {
 public:
  explicit KitRecordings(FilePath folder) : folder_(std::move(folder)) {}

  /// All ids with a _meta.json, sorted. Throws io_error 401.
  std::vector<std::string> ids() const;
  /// The texts of a recording. None if its metadata say so; TEMOS skips such recordings. Throws io_error 401, 403
  /// (malformed; another number of texts than announced), config_error 107.
  std::vector<std::string> annotations(const std::string& id) const;
  /// Throws as annotations and parse_kit_joints.
  KitRecording load(const std::string& id) const;

 private:
  FilePath file(const std::string& id, std::string_view ending) const;
  FilePath folder_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/kit_recordings.ipp>
#endif
