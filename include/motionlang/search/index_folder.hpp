// SPDX-License-Identifier: MIT
/// An index of a folder of motions, made and kept up to date: files that have not changed are not read again, files
/// that have only moved keep their vectors.
///
///     MotionIndex index(index_model(tmr));
///     const IndexReport report = update_index(index, "clips", tmr);
///     for (const std::string& problem : report.skipped) std::cerr << problem << "\n";
///     write_motion_index("clips.index", index, motion_graphs(index, 100'000));
#pragma once

#include <cstdint>     // times of files
#include <filesystem>  // paths
#include <map>         // files by path
#include <set>         // files that changed
#include <string>      // paths
#include <vector>      // files

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/clip_lines.hpp>
#include <motionlang/formats/motion_folder.hpp>
#include <motionlang/search/motion_search.hpp>
#include <motionlang/search/search_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The moments of a new index.
struct MomentOptions {
  std::vector<double> windows{1, 2, 3};  // lengths, seconds; none: only whole clips
  double stride = 0.5;                   // from one moment to the next, seconds
};
/// The model entry of an index with these vectors: that of the encoder, with the windows in its frames.
IndexModel index_model(const SearchEncoder& encoder, const MomentOptions& moments = {});

struct IndexOptions {
  std::vector<ClipLine> captions{};  // parts of clips and what they show (read_captions)
  std::string license{};             // of all motions of the folder; "": the first line of the LICENSE file beside or
                                     // above them; without such a file, what the index had
  bool again = false;                // read all files, changed or not
  MotionReadOptions read{};          // of all files, as options_for_file has it
};

/// The report of an update.
struct IndexReport {
  Index added = 0, removed = 0;              // clips
  Index renamed = 0, unchanged = 0;          // files
  Index relicensed = 0;                      // files that were not read again but have another license now
  std::vector<std::string> skipped{};        // "a.bvh: why", clips that could not be read or encoded
  std::vector<std::string> unknown_clips{};  // that the captions name and the folder lacks
  std::string folder_notes{};                // a line about each folder and file that could not be looked at
  bool changed() const { return added + removed + renamed + relicensed > 0; }
};

/// The update of an index by a folder and all below it. It is made in two steps, so that a caller can say how much
/// there is to do.
class IndexUpdate {
 public:
  /// Looks at the files: forgets clips of files that are gone, renames what has only moved. The texts of captions are
  /// encoded. Index and encoder have to outlive the object.
  /// Throws  io_error 401 if the folder cannot be read, and what SearchEncoder::encode_texts throws
  IndexUpdate(MotionIndex& index, const FilePath& folder, const SearchEncoder& encoder, IndexOptions options = {});

  /// Motion files below the folder, and those of them that are to be read.
  Index files() const { return std::ssize(files_); }
  Index fresh_files() const { return std::ssize(fresh_); }
  const std::filesystem::path& folder() const { return folder_; }

  /// Reads, encodes and adds what is new. A file that fails stops no other.
  /// progress  is called after some files each, with the number of files that are done
  /// Throws    cancelled if `progress` stops it: what was encoded until then is in the index
  void run(Progress progress = {});

  const IndexReport& report() const { return report_; }

 private:
  /// A file as the file system has it.
  struct FileState {
    std::filesystem::path path;
    std::int64_t modified = 0, bytes = 0;
  };
  /// A clip on its way into the index, or why it does not get there.
  struct Prepared {
    IndexedClip clip;
    std::vector<float> rows;
    std::string problem;
  };

  void look_at_files();
  void take_captions();
  void find_changes();
  bool has_lines(const IndexedClip& c, const std::string& path) const;
  void keep(const IndexedClip& c, const std::string& path);
  std::string license_of(const std::filesystem::path& path, const std::string& before);
  const std::string& license_beside(const std::filesystem::path& folder);
  void add(std::span<const FileState> files);
  std::vector<Prepared> prepare(const FileState& file) const;
  void encode(Prepared p);

  MotionIndex& index_;
  const SearchEncoder& encoder_;
  std::filesystem::path folder_;
  IndexOptions options_;
  IndexReport report_;
  std::vector<FileState> files_, fresh_;
  std::map<std::string, std::vector<ClipLine>> lines_of_;  // by the path of their file
  std::map<std::string, std::vector<float>> vector_of_;    // of captions
  std::map<std::string, std::string> license_before_;      // of files that are read again for their captions
  std::map<std::filesystem::path, std::string> licenses_;  // of folders
};

/// IndexUpdate in one call. Throws what it throws.
IndexReport update_index(MotionIndex& index, const FilePath& folder, const SearchEncoder& encoder,
                         IndexOptions options = {}, Progress progress = {});

/// A path as an index keeps it: absolute, without links, and without a slash at its end.
std::filesystem::path indexed_path(const FilePath& path);
/// True if an absolute path is the folder or in it.
bool is_below(const std::filesystem::path& path, const std::filesystem::path& folder);
/// Takes the clips of a file, or of all files below a folder, out of an index. Returns how many clips that were.
Index remove_below(MotionIndex& index, const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/index_folder.ipp>
#endif
