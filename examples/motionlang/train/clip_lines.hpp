// Tables of clips: what happens when in which file, as captions or as labels, which annotation files have, too. And the
// clips that they name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/motion.hpp>

namespace program {

namespace ml = motionlang;

/// A line of a table, or a stretch of an annotation file.
struct ClipLine {
  std::string place;               // "captions.tsv:12", for messages
  std::string id;                  // in lists of ids: the clip, or what the annotation file calls the motion
  std::string clip;                // path of the file in the folder of clips, without extension
  double start = 0, end = 0;       // seconds; to the end of the clip: infinite
  ml::BodyParts parts{};           // that captions are about; nothing for labels
  std::vector<std::string> texts;  // captions, or labels
};

/// clip, start, end, body parts, captions separated by |; or clip, captions: all of it. Columns are separated by tabs,
/// lines that begin with # are comments; a clip may have the extension of its file. Throws io_error 401, 403 with file
/// and line.
std::vector<ClipLine> read_captions(const std::filesystem::path& path);
/// clip, start, end, label; or clip, label: all of it; clips as in captions. Throws io_error 401, 403 with file and
/// line.
std::vector<ClipLine> read_labels(const std::filesystem::path& path);

/// The stretches of an annotation file with the labels that each has; some may have none, some several.
///     the unified file of TMR    "label" or "act_cat" of an annotation, which is besides what others read there
///     BABEL's own                "act_cat" of the stretches, or of the whole where there are no stretches
/// data     the folder of clips
/// labels   a table with two columns in their place: what a stretch (seg_id), a motion (its id) or a text is labelled;
///          "": none
/// Throws   io_error 401, 403, config_error 107 with the place; io_error 403 if no stretch has a label
std::vector<ClipLine> read_labelled_annotations(const std::filesystem::path& annotations,
                                                const std::filesystem::path& data, const std::filesystem::path& labels);

/// The file of a clip: .bvh, .npz (AMASS), .amc or .npy, of a data set in HumanML3D's form its features; "" if there is
/// none.
std::filesystem::path clip_file(const std::filesystem::path& data, const std::string& clip);

/// "CMU/CMU/141/141_05_poses.npz" of BABEL, which has the folder of the data set twice, as the path of a clip.
std::string babel_clip(const std::filesystem::path& data, const std::string& feat_p);

/// The clip of a line on our skeleton, at its own frame rate. Features without rotations get such that fit their
/// positions.
/// Throws io_error 401 if there is no file, and what the readers throw.
ml::Motion read_clip(const std::filesystem::path& data, const ClipLine& line);

/// Which frames of its clip a line is about.
ml::FrameSlice frames_of(const ml::Motion& clip, const ClipLine& line);
/// These frames. Throws io_error 403 if there are fewer than `least`.
ml::Motion segment_of(const ml::Motion& clip, const ClipLine& line, ml::Index least);

}  // namespace program
