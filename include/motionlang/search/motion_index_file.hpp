// SPDX-License-Identifier: MIT
/// A MotionIndex as one file. Its vectors are used in place.
///
///     MotionIndex index = read_motion_index("moves.index");
///     index.add(clip);
///    write_motion_index("moves.index", index);                     // the old file stays complete until then
///
/// Layout   safetensors, so any reader of it can load the vectors, with
///             clips, moments, captions   F32 (n, width), rows of length 1
///             moment_frames              I64 (moments, 3): clip, first frame, frames
///             about                      U8: JSON, {"model": {...}, "clips": [{"path", "modified", ...}, ...]}
///             graph_clips, graph_moments U8, if there is one: search/vector_graph.hpp
///         and "format", "version" and "checksum" (of all tensors) in the metadata
/// Checked  Everything is checked before any vector is handed out: a file that was cut off or changed is refused
#pragma once

#include <map>  // graphs

#include <motionlang/file/safetensors.hpp>
#include <motionlang/search/motion_index.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Further entries of an index file: bytes by the name of their tensor ("graph_clips").
using IndexExtras = std::map<std::string, std::vector<std::byte>>;

namespace detail {

inline constexpr const char *index_format = "motionlang.index", *index_version = "1";

}  // namespace detail

/// An open index file.
class MotionIndexFile {
 public:
  /// Throws io_error 401, 402 (ends too early), 403 (not an index, or damaged), 404 (another version), 405, 406, 407;
  /// config_error 107; numeric_error 302
  static MotionIndexFile open(const FilePath& path);
  static MotionIndexFile from_bytes(std::span<const std::byte> bytes, std::string name = "index",
                                    std::shared_ptr<const void> owner = {});

  const std::string& name() const { return file_.name(); }
  const MotionIndex& index() const { return index_; }
  /// The bytes of another tensor. Nothing if it does not exist.
  std::span<const std::byte> extra(std::string_view name) const;

 private:
  explicit MotionIndexFile(SafetensorsFile file) : file_(std::move(file)), index_(read(file_)) {}

  static MotionIndex read(const SafetensorsFile& file);

  SafetensorsFile file_;
  MotionIndex index_;
};

inline MotionIndex read_motion_index(const FilePath& path) { return MotionIndexFile::open(path).index(); }

std::vector<std::byte> motion_index_bytes(const MotionIndex& index, const IndexExtras& extras = {});
/// Throws io_error 401.
void write_motion_index(const FilePath& path, const MotionIndex& index, const IndexExtras& extras = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/motion_index_file.ipp>
#endif
