// SPDX-License-Identifier: MIT
// Bodies of kept_index.hpp.
#pragma once

#include <utility>  // move

#include <motionlang/core/option_error.hpp>
#include <motionlang/search/kept_index.hpp>
#include <motionlang/weights/run_folder.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY KeptIndex::KeptIndex(std::filesystem::path file, Index graph_from, Index shard_bytes)
    : file_(std::move(file)), graph_from_(graph_from), shard_bytes_(shard_bytes) {
  if (is_shard_folder(file_)) {
    shards_ = std::make_unique<ShardStore>(file_, shard_bytes);
    is_new_ = false;
    return;
  }
  if (!std::filesystem::exists(file_)) return;
  if (shard_bytes > 0 && !std::filesystem::is_directory(file_))
    raise<option_error>(102, file_.string(), " is one file; an index in shards is a folder, which needs another name");
  if (shard_bytes > 0) return;
  before_ = MotionIndexFile::open(file_);
  index_ = before_->index();
  is_new_ = false;
}

MOTIONLANG_BODY ClipStore& KeptIndex::store() {
  if (shards_) return *shards_;
  if (!store_) store_.emplace(*index_);
  return *store_;
}

MOTIONLANG_BODY std::filesystem::path KeptIndex::model_path(const FilePath& given, const FilePath& otherwise) const {
  const FilePath path = !given.string().empty() ? given : has_index() ? FilePath(model().path) : otherwise;
  return indexed_path(FilePath(found_model_folder(path)));
}

MOTIONLANG_BODY std::string KeptIndex::text_encoder(const FilePath& given) const {
  const std::string path = !given.string().empty() ? given.string() : has_index() ? model().text_encoder : "";
  return path.empty() ? "" : indexed_path(path).string();
}

MOTIONLANG_BODY void KeptIndex::take_model(const SearchEncoder& encoder, const MomentOptions* moments) {
  const IndexModel wanted = index_model(encoder, moments == nullptr ? MomentOptions{} : *moments);
  if (!has_index()) {
    if (shard_bytes_ > 0)
      shards_ = std::make_unique<ShardStore>(file_, wanted, shard_bytes_);
    else
      index_.emplace(wanted);
    return;
  }
  const IndexModel is = model();
  MotionIndex(is).require_model(wanted.id, wanted.path);
  if (moments != nullptr && (is.windows != wanted.windows || is.stride != wanted.stride))
    raise<option_error>(102, file_.string(), " has moments of ", is.windows.size(),
                        " other lengths or another stride; they are chosen when an index is made");
  model_moved_ = is.path != wanted.path || is.text_encoder != wanted.text_encoder;
  store().move_model(wanted.path, wanted.text_encoder);
}

MOTIONLANG_BODY bool KeptIndex::needs_writing(const IndexReport& report) const {
  return report.changed() || model_moved_ || is_new_ ||
         (before_ && MOTIONLANG_HAS_HNSWLIB && !has_graphs(*before_, graph_from_));
}

MOTIONLANG_BODY bool KeptIndex::lacks_hnswlib() const {
  return !MOTIONLANG_HAS_HNSWLIB && index_ && !detail::graph_rows(*index_, graph_from_).empty();
}

MOTIONLANG_BODY bool KeptIndex::write(Progress progress) {
  if (shards_) return shards_->write(), false;
  bool stopped = false;
  IndexExtras graphs;
  detail::guard<cancelled>(
      [&] { graphs = motion_graphs(*index_, graph_from_, progress, before_ ? &*before_ : nullptr); },
      [&](const cancelled&) { return stopped = true; });
  write_motion_index(file_, *index_, graphs);
  return stopped;
}

MOTIONLANG_BODY void KeptIndex::write_without_graphs() {
  if (shards_)
    shards_->write();
  else
    write_motion_index(file_, *index_);
}

MOTIONLANG_NAMESPACE_END
