// SPDX-License-Identifier: MIT
/// An index that is larger than memory: a folder of files of a stated size (shards), which are searched where they lie.
/// A search finds exactly what it finds in one index of all clips.
///
///     ShardStore store("moves.shards", index_model(tmr), Index{256} << 20);      // files of at most 256 MiB
///     store.add(clip);                                                           // again and again
///     store.write();
///
///     const auto shards = IndexShards::open("moves.shards");
///     const MotionSearch search = open_motion_search(shards);
///
/// Layout   shards.json lists the files with their sizes, checksums and numbers of clips, moments and captions. It is
///          written last, so a reader has the old shards or the new ones. One that has opened the folder keeps the old
///          ones. One that opens it while the list changes tries again. A shard is an index file
///          (search/motion_index_file.hpp) with further tensors:
///             clips_codes, moments_codes, captions_codes      I8 (n, width): each row in eight bits
///             clips_bounds, moments_bounds, captions_bounds   F32 (n, 2): scale s and allowance e of each row
///             clip_places     I64 (clips, 2): where the text of each clip begins and ends in `about`
///             caption_clips   I64 (captions): the clip of each caption
/// Scan     reads the codes c, a quarter of the vectors. The cosine of a row x with a query q of length 1 is
///             <x, q> = s <c, q> + <x - s c, q>  <=  s <c, q> + e,    as e >= |x - s c|
///          Only rows whose bound reaches the k-th best cosine are read and compared by exact_cosine.
/// Checked  When the folder is opened: the list, the size, the header, the model and the tables' shapes of each shard.
///          When clips are found: their texts, and the bound of each compared row. `check` reads every byte.
#pragma once

#include <filesystem>  // folders
#include <memory>      // shards
#include <optional>    // an unfinished shard
#include <utility>     // move

#include <motionlang/core/progress.hpp>
#include <motionlang/search/clip_store.hpp>
#include <motionlang/search/search.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A shard in the list of its folder.
struct ShardEntry {
  std::string file{};      // its name in the folder
  std::string checksum{};  // of its tensors
  Index bytes = 0, clips = 0, moments = 0, captions = 0;
  bool operator==(const ShardEntry&) const = default;
};
/// The list of a folder.
struct ShardList {
  IndexModel model{};
  Index shard_bytes = 0;
  std::vector<ShardEntry> shards{};
  bool operator==(const ShardList&) const = default;
};

/// The name of the list in its folder.
inline constexpr const char* shard_list_name = "shards.json";
/// True for a folder with a list.
bool is_shard_folder(const FilePath& folder);
/// Throws io_error 401, 403, 404, config_error 107.
ShardList read_shard_list(const FilePath& folder);

namespace detail {

/// Calls open(list). If that throws, and another program has written the list meanwhile, it tries again with the new
/// list, up to three times in all.
template <class Open>
void with_current_list(const FilePath& folder, const Open& open) {
  ShardList list = read_shard_list(folder);
  for (int left = 2;; --left) {
    const auto changed = [&](const error&) {
      if (left == 0) return false;
      ShardList now = read_shard_list(folder);
      const bool other = !(now == list);
      list = std::move(now);
      return other;
    };
    if (guard<error>([&] { open(list); }, changed)) return;
  }
}

}  // namespace detail

/// An open folder of shards.
class IndexShards : public IndexTables {
 public:
  /// Throws io_error 401 (no list, or a shard is missing), 402 (a shard is too short), 403 (malformed, or another file
  /// than the list says), 404, 405, 406, 407, config_error 102 (a shard of another model) and 107
  static std::shared_ptr<const IndexShards> open(const FilePath& folder);

  const std::string& name() const { return name_; }
  const ShardList& list() const { return list_; }
  const IndexModel& model() const override { return list_.model; }
  Index clip_count() const override { return clips_; }
  Index moment_count() const override { return moments_; }
  Index caption_count() const override { return captions_; }
  /// Reads one entry. Throws io_error 403, config_error 107 if it is damaged.
  IndexedClip clip(Index i) const override;
  MotionIndex::Moment moment(Index i) const override;
  Index clip_of_caption(Index i) const override;

  /// Searches the shards part, part + parts, part + 2 parts, ...; vectors have their numbers in the whole index. With
  /// more than one part, count() is still that of the whole index, and an answer is a part of the answer.
  std::shared_ptr<const VectorSearch> vectors(SearchFor what, Index part = 0, Index parts = 1) const;

  /// All clips in one index, in memory. Throws what MotionIndexFile::open throws.
  MotionIndex whole() const;
  /// Reads every byte. Throws io_error 403, numeric_error 302 if a checksum, a vector or a code is wrong.
  void check(Progress progress = {}) const;

 private:
  struct Shard {
    SafetensorsFile file;
    Index clip = 0, moment = 0, caption = 0;  // the numbers of the first ones
  };
  IndexShards(const FilePath& folder, ShardList list);
  Shard open_shard(const ShardEntry& entry, std::size_t number) const;
  std::string path_of(const ShardEntry& entry) const;
  /// The shard of a clip, moment or caption.
  const Shard& shard_of(Index Shard::*first, Index i) const;
  template <class T>
  static std::vector<T> numbers_at(const Shard& shard, const char* tensor, Index row);

  std::string name_;
  ShardList list_;
  std::vector<Shard> shards_;
  Index clips_ = 0, moments_ = 0, captions_ = 0;
};

/// Searches shards; with `parts`, those of a part (IndexShards::vectors).
MotionSearch open_motion_search(std::shared_ptr<const IndexShards> shards, Index part = 0, Index parts = 1);

/// A folder of shards that is made or changed. The vectors of at most one shard are in memory.
class ShardStore : public ClipStore {
 public:
  /// A new folder, or one that is there with the same model.
  /// shard_bytes  the largest size of a file; only a clip that needs more gets a larger one
  /// Throws       option_error 102 for less than 16 KiB, config_error 102 for another model, io_error 401, 403 (a
  ///              folder of other files), and what IndexShards::open throws
  ShardStore(const FilePath& folder, const IndexModel& model, Index shard_bytes);
  /// A folder that is there. shard_bytes 0: as it was.
  explicit ShardStore(const FilePath& folder, Index shard_bytes = 0);

  const IndexModel& model() const override { return list_.model; }
  std::span<const IndexedClip> clips() const override { return clips_; }
  Index moment_count() const override { return moments_; }
  /// Writes a shard when it is full. Throws what MotionIndex::add throws, io_error 401.
  void add(EncodedClip c) override;
  void rename(const std::string& from, const std::string& to) override;
  void set_license(const std::string& path, const std::string& license) override;
  void move_model(std::string path, std::string text_encoder) override;
  /// After an `add` it first calls write(), so readers find what was added until then.
  void remove(const std::vector<bool>& gone) override;

  /// Writes what has changed, then the list, and removes the files that only the earlier list has. Before that, readers
  /// find the old index. If it throws, the index is as before, and write() can be called again.
  /// Throws  io_error 401, and 403 if another program has written the list since this object read it
  void write();

 private:
  /// The place of a clip: a shard of the list, or -1 for one that was added, and its number there.
  struct Origin {
    Index shard = -1, clip = 0;
    Index moments = 0;
  };
  void take_up(const IndexShards& shards);
  void touch(std::size_t clip);
  void take_up_last_shard();
  ShardEntry write_shard(const MotionIndex& index);
  std::string new_file_name();
  void require_same_list() const;
  MotionIndex changed_shard(Index shard, std::span<const IndexedClip> clips, std::span<const Origin> origins) const;

  std::filesystem::path folder_;
  ShardList list_;
  std::optional<ShardList> published_;  // the list in the folder
  std::vector<std::string> made_;       // files that this object has written since
  std::vector<bool> changed_;           // for each shard of the list
  std::vector<ShardEntry> finished_;    // shards of added clips
  std::optional<MotionIndex> open_;     // added clips, for the next shard
  Index open_bytes_ = 0, moments_ = 0, next_number_ = 0;
  std::vector<IndexedClip> clips_;
  std::vector<Origin> origins_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/index_shards.ipp>
#endif
