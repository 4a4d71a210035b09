// SPDX-License-Identifier: MIT
/// The captions of a clip of HumanML3D or KIT-ML (texts/<id>.txt), and index.csv, which lists the sources of the clips.
///
///     caption#word/POS word/POS ...#start#end          seconds; 0.0 and 0.0: the whole clip; "nan" is 0
///
/// Source  Guo et al. (CVPR 2022); HumanML3D, README; text-to-motion data/dataset.py Text2MotionDatasetV2
#pragma once

#include <span>         // captions
#include <string>       // texts
#include <string_view>  // names
#include <vector>       // captions

#include <motionlang/datasets/humanml3d_source.hpp>
#include <motionlang/file/file_path.hpp>
#include <motionlang/text/tagged_word.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct MotionCaption {
  std::string text;
  std::vector<TaggedWord> words;  // may be empty; T2M and its evaluation need them
  double start = 0, end = 0;      // seconds
  bool of_whole_clip() const { return start == 0 && end == 0; }
  bool operator==(const MotionCaption&) const = default;
};

/// Fields are split off from the right, so a caption may contain '#'. Lines with fewer than four fields are skipped, as
/// published. Throws io_error 403, with the line, for an invalid time.
std::vector<MotionCaption> parse_captions(std::string_view text, std::string_view name = "captions");
/// Throws io_error 401, 403.
std::vector<MotionCaption> read_captions(const FilePath& path);

/// Messages contain `name`.
/// Laws    parse_captions(format_captions(x)) equals x
/// Throws  timeline_error 510 for a caption or word that other readers would split: with '#', a line end, blanks at its
///         ends or in a word, '/' in a tag; io_error 403 for an invalid time
std::string format_captions(std::span<const MotionCaption> captions, std::string_view name = "captions");

/// The caption of the mirrored clip, with left and right exchanged in the text and in its words.
MotionCaption mirrored(MotionCaption caption);

/// Parses index.csv: a header line, then source_path,start_frame,end_frame,new_name. Throws io_error 403, with the
/// line, for another number of fields, and for a frame that is below -1 or not an integer.
std::vector<HumanMl3dSource> parse_humanml3d_index(std::string_view text, std::string_view name = "index.csv");
/// Throws io_error 401, 403.
std::vector<HumanMl3dSource> read_humanml3d_index(const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/humanml3d_texts.ipp>
#endif
