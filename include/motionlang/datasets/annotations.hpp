// SPDX-License-Identifier: MIT
/// The annotation JSON of TMR and STMC: the texts for ranges of seconds of AMASS sequences. It is read entry by entry
/// and written in the published layout.
///
///     {"000000": {"path": "KIT/3/kick_high_left02_poses", "duration": 5.82, "annotations": [
///         {"seg_id": "000000_0", "text": "a man kicks.", "start": 0.0, "end": 5.82}, ...]}, ...}
///
///     const auto file = AnnotationFile::open("annotations.json");
///     for (const std::string& id : file.select(read_ids("splits/train.txt"))) {
///       for (const Annotation& a : training_annotations(file.load(id), "train")) use(a);
///     }
///
/// Source  AMASS-Annotation-Unifier; TMR (Petrovich et al. 2023), src/data/text_motion.py
#pragma once

#include <span>         // ids
#include <string>       // texts
#include <string_view>  // names of splits
#include <utility>      // move
#include <vector>       // annotations

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/file/json_members.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class JsonView;

struct Annotation {
  std::string seg_id;  // "<id>_<number>"
  std::string text;
  double start = 0, end = 0;  // seconds
  std::string babel_id{};     // for a label of BABEL: its seg_id there
  bool operator==(const Annotation&) const = default;
};

struct AnnotatedMotion {
  std::string id;
  std::string path;  // AMASS-relative, without extension; "M/..." of mirrored motions, "humanact12/..." of HumanAct12
  double duration = 0;  // seconds
  std::vector<Annotation> annotations;
  bool operator==(const AnnotatedMotion&) const = default;
};

/// An annotation file that is open for reading. Entries are parsed on request.
class AnnotationFile {
 public:
  /// From a file that is already open.
  explicit AnnotationFile(JsonMembers members) : members_(std::move(members)) {}
  /// Throws io_error 401, 403 (JsonMembers).
  static AnnotationFile open(const FilePath& path);
  static AnnotationFile from_text(std::string text, std::string name = "annotations");

  /// In the order of the file.
  const std::vector<std::string>& ids() const { return members_.keys(); }
  bool has(const std::string& id) const { return members_.has(id); }

  /// Throws config_error 103 for an unknown id, 107 for a value of the wrong kind (with its path), io_error 403 for
  /// malformed JSON (with line and column) and for times that are not valid.
  AnnotatedMotion load(const std::string& id) const;
  /// The motion of an entry. Throws what load throws for its values.
  static AnnotatedMotion parse(const std::string& id, const JsonView& view);

  /// The ids of a split that have an entry, in the order of the split. The others are left out without a warning, as
  /// published.
  std::vector<std::string> select(std::span<const std::string> split) const;

 private:
  JsonMembers members_;
};

/// The training texts of TMR: texts of 2 to 10 seconds. A split whose name contains "test" keeps all. Motions without
/// such texts are left out of the split. Evaluation takes the first text.
std::vector<Annotation> training_annotations(const AnnotatedMotion& motion, std::string_view split, double least = 2,
                                             double most = 10);

/// The frames of a text: int(start fps) up to int(end fps), cut at the end of the motion.
FrameSlice annotated_frames(const Annotation& a, double fps, Index frames);

/// The entry of the mirrored motion: "M" before id, seg_id and path, and captions with the sides exchanged.
AnnotatedMotion mirrored(AnnotatedMotion motion);

/// The text of an annotation file in the layout of the published ones.
/// Laws    AnnotationFile::from_text(annotations_json(x)) loads x
/// Throws  io_error 403 for a repeated id, a text that is not UTF-8, and times that are not valid
std::string annotations_json(std::span<const AnnotatedMotion> motions);
/// Throws io_error 401 and as annotations_json.
void write_annotations(const FilePath& path, std::span<const AnnotatedMotion> motions);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/annotations.ipp>
#endif
