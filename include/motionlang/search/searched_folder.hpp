// SPDX-License-Identifier: MIT
/// Searches a folder of motions by words while its files come and go: every search first reads the files that have
/// changed.
///
///     SearchedFolder folder("clips", encoder, {.index = "clips/.motionlang.index"});
///     for (const FolderMoment& moment : folder.find("a person jumps", 10).moments)
///       use(folder.piece(moment, 2).motion);
///
/// Links    are not followed, so no file elsewhere is read
/// Threads  one at a time calls find; any number call piece
#pragma once

#include <filesystem>  // the folder
#include <memory>      // the encoder
#include <string>      // texts
#include <vector>      // moments

#include <motionlang/core/progress.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/search/index_folder.hpp>
#include <motionlang/search/search_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A moment of a motion in the folder.
struct FolderMoment {
  std::string file{};         // in the folder, with '/' behind subfolders
  std::string animation{};    // of a file with several motions; "": the only one
  double start = 0, end = 0;  // seconds in the file
  double score = 0;           // from 0 to 1, as TextAnswer has it
  bool operator==(const FolderMoment&) const = default;
};

/// The answer to a text.
struct FolderAnswer {
  std::vector<FolderMoment> moments{};  // best first
  bool shown = true;                    // false: no moment shows the text
  std::vector<std::string> unknown{};   // words that the model knows nothing about
  Index clips = 0;                      // in the folder
  Index skipped = 0;                    // that could not be read or encoded
};

/// A moment with some of the motion around it.
struct FolderPiece {
  Motion motion;
  double start = 0, end = 0;  // of the moment, in seconds of `motion`
};

/// The motion of a file from `start` to `end`, with `margin` seconds before and after it, as far as the file has them.
/// animation: of a file with several motions; "": the first one. Throws io_error 401 if the file has no such motion,
/// and what read_motions throws.
FolderPiece piece_of_file(const std::filesystem::path& file, const std::string& animation, double start, double end,
                          double margin);

struct SearchedFolderOptions {
  std::filesystem::path index{};  // file in which the vectors are for the next time; "": they are only in memory
  MomentOptions moments{};        // of a new index
};

class SearchedFolder {
 public:
  /// Takes up the index if it is one of this encoder. One that is not, or that is damaged, is made anew.
  /// Throws io_error 401 if there is no such folder, config_error 101 without an encoder.
  SearchedFolder(const FilePath& folder, std::shared_ptr<const SearchEncoder> encoder,
                 SearchedFolderOptions options = {});

  /// The moments that are nearest to a text. `progress` gets the number of files of those that are read.
  /// Throws io_error 401 if the folder cannot be read; cancelled, and then the next search goes on from there; and what
  /// answer_text throws.
  FolderAnswer find(const std::string& text, Index top, Progress progress = {});

  /// The motion of a moment, with this many seconds before and after it, as far as the file has them.
  /// Throws io_error 401 if the file is gone or elsewhere, and what read_motions throws.
  FolderPiece piece(const FolderMoment& moment, double margin = 0) const;

 private:
  MotionIndex taken_up() const;
  void keep(const IndexReport& report) const;

  std::filesystem::path folder_;
  std::shared_ptr<const SearchEncoder> encoder_;
  SearchedFolderOptions o_;
  MotionIndex index_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/searched_folder.ipp>
#endif
