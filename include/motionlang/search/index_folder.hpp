// SPDX-License-Identifier: MIT
/// Makes an index of a folder of motions and updates it. Unchanged files are not read again, and files that have only
/// moved keep their vectors.
///
///     MotionIndex index(index_model(tmr));
///     const IndexReport report = update_index(index, "clips", tmr);
///     for (const std::string& problem : report.skipped) std::cerr << problem << "\n";
///     write_motion_index("clips.index", index, motion_graphs(index, 100'000));
#pragma once

#include <cstdint>     // times of files
#include <filesystem>  // paths
#include <map>         // files by path
#include <memory>      // stores
#include <optional>    // captions
#include <set>         // files that changed
#include <string>      // paths
#include <vector>      // files

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/clip_lines.hpp>
#include <motionlang/formats/motion_folder.hpp>
#include <motionlang/search/clip_store.hpp>
#include <motionlang/search/motion_search.hpp>
#include <motionlang/search/search_encoder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The moments of a new index.
struct MomentOptions {
  std::vector<double> windows{1, 2, 3};  // lengths, seconds; none: only whole clips
  double stride = 0.5;                   // from one moment to the next, seconds
};
/// The model entry of an index with these vectors: the encoder's, with the windows in its frames.
IndexModel index_model(const SearchEncoder& encoder, const MomentOptions& moments = {});

struct IndexOptions {
  std::vector<ClipLine> captions{};  // parts of clips and their captions (read_captions)
  std::string license{};             // of all motions of the folder; "": the first line of the LICENSE file beside or
                                     // above them; without such a file, what the index had
  bool again = false;                // read all files, changed or not
  MotionReadOptions read{};          // of all files, see options_for_file
  bool skip_links = false;           // leave out links to files; links to folders are never followed
};

/// The report of an update.
struct IndexReport {
  Index added = 0, removed = 0;              // clips
  Index renamed = 0, unchanged = 0;          // files
  Index relicensed = 0;                      // files that were not read again but have another licence now
  std::vector<std::string> skipped{};        // "a.bvh: reason", clips that could not be read or encoded
  std::vector<std::string> unknown_clips{};  // named by the captions, but not in the folder
  std::string folder_notes{};                // a line about each folder and file that could not be read
  bool changed() const { return added + removed + renamed + relicensed > 0; }
};

/// A file that an update reads.
struct FileToIndex {
  std::filesystem::path path{};
  std::int64_t modified = 0, bytes = 0;
  std::optional<std::vector<ClipLine>> lines{};  // the captions that cut it into clips, if they name it
};
/// A clip of such a file with its vectors, except those of its captions; or the reason why it cannot be indexed.
struct ClipToIndex {
  EncodedClip clip{};
  std::string problem{};
};
/// Reads and encodes files, for IndexUpdate::run. Several processes share this work (train/shared_index.hpp).
class FileEncoder {
 public:
  virtual ~FileEncoder() = default;
  /// The number of files that it wants at once.
  virtual Index at_once() const = 0;
  /// The clips of each file, in the order of the files.
  virtual std::vector<std::vector<ClipToIndex>> encode(std::span<const FileToIndex> files) = 0;
};
/// The clips of files. Threads share the reading, and inside the model the encoding. Equal files give equal clips,
/// independent of the other files.
std::vector<std::vector<ClipToIndex>> encode_files(std::span<const FileToIndex> files, const SearchEncoder& encoder,
                                                   const IndexModel& model, const MotionReadOptions& read = {});

/// An update of an index from a folder and its subfolders. It has two steps, so that the caller can announce the amount
/// of work.
class IndexUpdate {
 public:
  /// Looks at the files: forgets clips of deleted files, and renames moved ones. Encodes the texts of captions. Index
  /// and encoder must outlive the object.
  /// Throws  io_error 401 if the folder cannot be read, and what SearchEncoder::encode_texts throws
  IndexUpdate(ClipStore& index, const FilePath& folder, const SearchEncoder& encoder, IndexOptions options = {});
  IndexUpdate(MotionIndex& index, const FilePath& folder, const SearchEncoder& encoder, IndexOptions options = {});

  /// Motion files below the folder, and those of them that will be read.
  Index files() const { return std::ssize(files_); }
  Index fresh_files() const { return std::ssize(fresh_); }
  const std::filesystem::path& folder() const { return folder_; }

  /// Reads, encodes and adds new clips. A file that fails does not stop the others.
  /// progress  is called after every few files, with the number of finished files
  /// others    reads and encodes instead of this process alone
  /// Throws    cancelled if `progress` stops it; clips that are already encoded are then in the index
  void run(Progress progress = {}, FileEncoder* others = nullptr);

  const IndexReport& report() const { return report_; }

 private:
  IndexUpdate(std::shared_ptr<ClipStore> index, const FilePath& folder, const SearchEncoder& encoder,
              IndexOptions options);
  void look_at_files();
  void take_captions();
  void find_changes();
  bool has_lines(const IndexedClip& c, const std::string& path) const;
  void keep(const IndexedClip& c, const std::string& path);
  std::string license_of(const std::filesystem::path& path, const std::string& before);
  const std::string& license_beside(const std::filesystem::path& folder);
  void take(const FileToIndex& file, std::vector<ClipToIndex> clips);

  std::shared_ptr<ClipStore> index_;
  const SearchEncoder& encoder_;
  std::filesystem::path folder_;
  IndexOptions options_;
  IndexReport report_;
  std::vector<FileToIndex> files_, fresh_;
  std::map<std::string, std::vector<ClipLine>> lines_of_;  // by the path of their file
  std::map<std::string, std::vector<float>> vector_of_;    // of captions
  std::map<std::string, std::string> license_before_;      // of files that are read again for their captions
  std::map<std::filesystem::path, std::string> licenses_;  // of folders
};

/// IndexUpdate in one call. Throws what it throws.
IndexReport update_index(MotionIndex& index, const FilePath& folder, const SearchEncoder& encoder,
                         IndexOptions options = {}, Progress progress = {});

/// A path in the form of an index: absolute, without links, and without a slash at its end.
std::filesystem::path indexed_path(const FilePath& path);
/// True if an absolute path is the folder or in it.
bool is_below(const std::filesystem::path& path, const std::filesystem::path& folder);
/// True for a link to a motion, and for an AMC file whose skeleton is one.
bool is_linked_motion(const std::filesystem::path& path);
/// Removes the clips of a file, or of all files below a folder, from an index. Returns the number of these clips.
Index remove_below(ClipStore& index, const FilePath& path);
inline Index remove_below(MotionIndex& index, const FilePath& path) {
  StoreOfIndex store(index);
  return remove_below(store, path);
}

/// A line for each clip of an index, with tabs: path and animation, start, end, frames per second, frames, captions,
/// licence.
std::string listed_clips(std::span<const IndexedClip> clips);
inline std::string listed_clips(const MotionIndex& index) { return listed_clips(index.clips()); }
/// The size of an index after an update, and what the update changed, as lines.
std::string describe_update(Index clips, Index moments, const IndexReport& report);
inline std::string describe_update(const MotionIndex& index, const IndexReport& report) {
  return describe_update(index.count(), std::ssize(index.moments()), report);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/index_folder.ipp>
#endif
