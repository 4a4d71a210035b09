// SPDX-License-Identifier: MIT
/// An index file that is made, updated by folders, and written with its graphs only where something has changed.
///
///     KeptIndex kept("clips.index");
///     const TmrSearchEncoder<B> tmr(load_tmr<B>(kept.model_path("", "examples/models/tmr_free")));
///     kept.take_model(tmr);
///     IndexUpdate update(kept.index(), "clips", tmr);
///     update.run();
///     if (kept.needs_writing(update.report())) kept.write();
#pragma once

#include <filesystem>  // the file
#include <optional>    // none yet
#include <string>      // models

#include <motionlang/core/lifetime.hpp>
#include <motionlang/search/index_folder.hpp>
#include <motionlang/search/vector_graph.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class KeptIndex {
 public:
  /// Opens the file if it is there. From `graph_from` clips or moments on, searches follow a graph.
  explicit KeptIndex(std::filesystem::path file, Index graph_from = 100'000);

  /// False until there is a file, or a model was taken.
  bool has_index() const { return index_.has_value(); }
  MotionIndex& index() MOTIONLANG_LIFETIMEBOUND { return *index_; }
  const MotionIndex& index() const MOTIONLANG_LIFETIMEBOUND { return *index_; }

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
  std::filesystem::path file_;
  Index graph_from_;
  std::optional<MotionIndexFile> before_;
  std::optional<MotionIndex> index_;
  bool model_moved_ = false;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/kept_index.ipp>
#endif
