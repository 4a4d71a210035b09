// SPDX-License-Identifier: MIT
/// An index, one file or a folder of shards, that is made, updated by folders, and written only where something has
/// changed.
///
///     KeptIndex kept("clips.index");
///     const TmrSearchEncoder<B> tmr(load_tmr<B>(kept.model_path("", "examples/models/tmr_free")));
///     kept.take_model(tmr);
///     IndexUpdate update(kept.store(), "clips", tmr);
///     update.run();
///     if (kept.needs_writing(update.report())) kept.write();
#pragma once

#include <filesystem>  // the file
#include <optional>    // none yet
#include <string>      // models

#include <motionlang/core/lifetime.hpp>
#include <motionlang/search/index_folder.hpp>
#include <motionlang/search/index_shards.hpp>
#include <motionlang/search/vector_graph.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class KeptIndex {
 public:
  /// Opens the file or the folder of shards if it is there. From `graph_from` clips or moments on, searches of a file
  /// follow a graph; a folder has none.
  /// shard_bytes  above 0: a new index is a folder of files of at most this size
  /// Throws       option_error 102 if there is a file already and shard_bytes is above 0
  explicit KeptIndex(std::filesystem::path file, Index graph_from = 100'000, Index shard_bytes = 0);

  /// False until there is a file, or a model was taken.
  bool has_index() const { return index_.has_value() || shards_ != nullptr; }
  /// The index of one file.
  MotionIndex& index() MOTIONLANG_LIFETIMEBOUND { return *index_; }
  const MotionIndex& index() const MOTIONLANG_LIFETIMEBOUND { return *index_; }
  /// The clips of a file or of a folder.
  ClipStore& store() MOTIONLANG_LIFETIMEBOUND;

  /// Where the model is: `given`, else that of the index, else `otherwise`. An absolute path.
  std::filesystem::path model_path(const FilePath& given, const FilePath& otherwise) const;
  /// The text encoder: `given`, else that of the index; "" if there is none.
  std::string text_encoder(const FilePath& given) const;

  /// A new index gets this model and these moments. Of an index that is there, the model has to be the same; its place
  /// is noted.
  /// moments  null: those of the index, or the usual ones
  /// Throws   option_error 102 if the index has other moments, config_error 102 for another model
  void take_model(const SearchEncoder& encoder, const MomentOptions* moments = nullptr);

  /// True if the file lacks something: clips, the place of the model, graphs.
  bool needs_writing(const IndexReport& report) const;
  /// True if searches have to compare all, because this build has no hnswlib and there are many clips or moments.
  bool lacks_hnswlib() const;

  /// Writes the file. If `progress` stops it, the file has no graphs, and searches compare all until the next update.
  /// Returns whether it was stopped.
  bool write(Progress progress = {});
  void write_without_graphs();

 private:
  const IndexModel& model() const { return shards_ ? shards_->model() : index_->model(); }

  std::filesystem::path file_;
  Index graph_from_, shard_bytes_;
  std::optional<MotionIndexFile> before_;
  std::optional<MotionIndex> index_;
  std::optional<StoreOfIndex> store_;   // of that
  std::unique_ptr<ShardStore> shards_;  // instead
  bool is_new_ = true;
  bool model_moved_ = false;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/kept_index.ipp>
#endif
