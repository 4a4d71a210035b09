// SPDX-License-Identifier: MIT
/// Converts texts of motions between BABEL's JSON, the annotation JSON of TMR and STMC, and the caption files of
/// HumanML3D and KIT-ML.
///
///     const auto motions = read_annotated_texts("babel/train.json");
///     write_annotations("annotations.json", motions);
#pragma once

#include <filesystem>  // folders
#include <map>         // files by name
#include <string>      // texts
#include <vector>      // motions

#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/humanml3d_texts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The entries with texts of BABEL's JSON or of an annotation file. The content decides which one it is. Throws
/// io_error 401, 403, config_error 101 if no motion has a text, 107.
std::vector<AnnotatedMotion> read_annotated_texts(const FilePath& path);

/// Words have no tags, which only T2M's evaluator needs. The times of a text for the whole motion are 0 and 0.
std::vector<MotionCaption> captions_of(const AnnotatedMotion& motion);
/// Removes texts of no duration and returns their number. Caption files cannot distinguish a text from 0 to 0 seconds
/// from one for the whole motion.
std::size_t drop_momentary_texts(AnnotatedMotion& motion);
/// The caption files of motions: contents by name, "000001.txt". Messages contain `folder`. Throws config_error 102 if
/// two ids have one name, and timeline_error 510 for a text that a caption file cannot hold.
std::map<std::string, std::string> caption_files(const std::vector<AnnotatedMotion>& motions,
                                                 const std::string& folder = "texts");

/// Converts BABEL's or annotation JSON to annotation JSON (.json), or to caption files in the folder texts/ of `out`, a
/// folder without extension. Returns lines about the result. Texts of no duration do not go into caption files.
/// Throws  config_error 103 for another extension; option_error 102 if `out` is `in`; what read_annotated_texts,
///         caption_files and the writers throw
std::string convert_texts(const std::filesystem::path& in, const std::filesystem::path& out);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/annotated_texts.ipp>
#endif
