// SPDX-License-Identifier: MIT
/// Tables of clips: the action in a range of a file, as captions or as labels. Annotation files give such labels, too.
/// Also finds the clips that these files name.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A line of a table, or a segment of an annotation file.
struct ClipLine {
  std::string place;               // "captions.tsv:12", for messages
  std::string id;                  // in lists of ids: the clip, or the name of the motion in the annotation file
  std::string clip;                // path in the folder of clips; with the extension if others have the same without it
  double start = 0, end = 0;       // seconds; to the end of the clip: infinite
  BodyParts parts{};               // the parts that captions describe; none for labels
  std::vector<std::string> texts;  // captions, or labels
  std::filesystem::path file{};    // of the clip; "": there is none
  std::string animation{};         // in a file of several: "Waving" of the clip "figure.glb#Waving"
  bool repeat = false;             // the segment is one cycle, and may be played again and again
  bool hold = false;               // its last pose may be held
  bool seated = false;             // low hips rest on the floor (FloorFixOptions::seated)
  std::vector<ClipLine> then{};    // one clip, all of which may follow again and again, or none
};

namespace detail {

/// Throws io_error 403 with the place of the line.
[[noreturn]] void raise_clip_line(const ClipLine& line, const std::string& what);

}  // namespace detail

/// A folder of clips. Finds files by their names in tables and annotation files: the path with its extension, or
/// without it if that is unique. In a data set in HumanML3D's form, it also finds clips by the names of their features.
/// In AMASS it knows the older and newer names of the folders.
class ClipFolder {
 public:
  explicit ClipFolder(std::filesystem::path folder);

  /// The file of a clip: .bvh, .amc, .npz, .npy, .glb or .vrma; "" if there is none. Throws io_error 403 if several
  /// files fit. The message begins with the place of the name.
  std::filesystem::path file(const std::string& clip, const std::string& place);
  /// Finds the file of a line, and of the clip that follows. The clip, and an id that equals the clip, lose an
  /// extension that is not needed. If no file has the name, the text after its last # is an animation.
  void find(ClipLine& line);

 private:
  using Stems = std::multimap<std::string, std::filesystem::path>;  // files by their names without extension
  const Stems& listed(const std::filesystem::path& folder);
  /// The files with this path if extensions are ignored.
  std::vector<std::filesystem::path> namesakes(const std::filesystem::path& name);

  std::vector<std::filesystem::path> places_;  // folders in which paths start
  std::map<std::filesystem::path, Stems> listed_;
};

/// Lines "clip, start, end, body parts, captions separated by |", or "clip, captions" for the whole clip. Columns are
/// separated by tabs, and lines that start with # are comments. A sixth column may say how a segment continues if more
/// time is wanted, separated by commas: "repeat", "hold", "then CLIP"; and "seated". data: the folder of clips. Throws
/// io_error 401, 403 with file and line.
std::vector<ClipLine> read_captions(const std::filesystem::path& path, const std::filesystem::path& data);
/// Lines "clip, start, end, label", or "clip, label" for the whole clip; clips as in captions. Throws io_error 401, 403
/// with file and line.
std::vector<ClipLine> read_labels(const std::filesystem::path& path, const std::filesystem::path& data);

/// The segments of an annotation file with their labels. A segment may have none or several.
///     the unified file of TMR    "label" or "act_cat" of an annotation, beside its other members
///     BABEL's own                "act_cat" of the segments, or of the whole if there are no segments
/// data     the folder of clips
/// labels   a table of two columns that replaces them: a segment (seg_id), a motion (its id) or a text, and its label;
///          "": none
/// Throws   io_error 401, 403, config_error 107 with the place; io_error 403 if no segment has a label
std::vector<ClipLine> read_labelled_annotations(const std::filesystem::path& annotations,
                                                const std::filesystem::path& data, const std::filesystem::path& labels);

/// BABEL's "CMU/CMU/141/141_05_poses.npz", which has the folder of the data set twice, as the path of a clip. place:
/// where this name was read. Throws what ClipFolder::file throws.
std::string babel_clip(ClipFolder& clips, const std::string& feat_p, const std::string& place);

/// The clip of a line on our skeleton, at its own frame rate, from a .bvh, .amc, .npz (AMASS), .npy, .glb or .vrma file
/// in the folder `data`. Features without rotations get rotations that fit their positions. Throws io_error 401 if
/// there is no file, 404 for an unknown kind of file, config_error 103 for an animation that the file lacks, 102 if it
/// has several and the line names none, and what the readers throw.
Motion read_clip(const std::filesystem::path& data, const ClipLine& line);

/// The frames of its clip that a line describes.
FrameSlice frames_of(const Motion& clip, const ClipLine& line);
/// These frames. Throws io_error 403 if there are fewer than `least`.
Motion segment_of(const Motion& clip, const ClipLine& line, Index least);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/clip_lines.ipp>
#endif
