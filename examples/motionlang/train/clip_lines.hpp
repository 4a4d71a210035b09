// Tables of clips: what happens when in which file, as captions or as labels. And the clips that they name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/motion.hpp>

namespace program {

namespace ml = motionlang;

/// A line of a table.
struct ClipLine {
  std::string place;               // "captions.tsv:12", for messages
  std::string clip;                // path of the file in the folder of clips, without extension
  double start = 0, end = 0;       // seconds
  ml::BodyParts parts{};           // that captions are about; nothing for labels
  std::vector<std::string> texts;  // captions, or the one label
};

/// clip, start, end, body parts, captions separated by |. Columns are separated by tabs, lines that begin with # are
/// comments. Throws io_error 401, 403 with file and line.
std::vector<ClipLine> read_captions(const std::filesystem::path& path);
/// clip, start, end, label. Throws io_error 401, 403 with file and line.
std::vector<ClipLine> read_labels(const std::filesystem::path& path);

/// The clip of a line on our skeleton, at its own frame rate: .bvh, .npz (AMASS), or .amc with its .asf. Throws io_error
/// 401 if there is none, and what the readers throw.
ml::Motion read_clip(const std::filesystem::path& data, const ClipLine& line);

/// The frames of a line out of its clip. Throws io_error 403 if there are fewer than `least`.
ml::Motion segment_of(const ml::Motion& clip, const ClipLine& line, ml::Index least);

}  // namespace program
