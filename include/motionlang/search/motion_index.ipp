// SPDX-License-Identifier: MIT
// Bodies of motion_index.hpp.
#pragma once

#include <algorithm>  // all_of
#include <cmath>      // isfinite
#include <limits>     // the largest frame

#include <motionlang/search/motion_index.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY MotionIndex::MotionIndex(IndexModel model) : model_(std::move(model)) {
  const auto positive = [](Index n) { return n > 0; };
  if (model_.width < 1 || !(model_.fps > 0 && std::isfinite(model_.fps)) ||
      !std::all_of(model_.windows.begin(), model_.windows.end(), positive) ||
      (!model_.windows.empty() && model_.stride < 1))
    raise<config_error>(101, "MotionIndex: vectors of ", counted(model_.width, "number"), ", ", model_.fps,
                        " frames per second, ", counted(model_.windows.size(), "window"), ", stride ", model_.stride);
}

MOTIONLANG_BODY MotionIndex::MotionIndex(std::string_view where, IndexModel model, std::vector<IndexedClip> clips,
                                         std::vector<Moment> moments, VectorTable clip_rows, VectorTable moment_rows,
                                         VectorTable caption_rows)
    : MotionIndex(std::move(model)) {
  clips_ = std::move(clips), moments_ = std::move(moments);
  clip_rows_ = std::move(clip_rows), moment_rows_ = std::move(moment_rows), caption_rows_ = std::move(caption_rows);
  for (std::size_t i = 0; i < clips_.size(); ++i)
    caption_clips_.insert(caption_clips_.end(), clips_[i].captions.size(), static_cast<Index>(i));
  require_rows(where, "clips", clips_.size(), clip_rows_);
  require_rows(where, "moments", moments_.size(), moment_rows_);
  require_rows(where, "captions", caption_clips_.size(), caption_rows_);
  Index last = 0;
  for (const Moment& m : moments_) {
    if (m.clip < last || m.clip >= count() || !is_moment(m.frames))
      raise<io_error>(403, where, ": a moment of ", counted(m.frames.length, "frame"), " at ", m.frames.first,
                      " of clip ", m.clip, " among ", count());
    last = m.clip;
  }
}

MOTIONLANG_BODY void MotionIndex::require_model(std::string_view id, std::string_view path) const {
  if (id != model_.id)
    raise<config_error>(102, "this index was made with the model '", model_.path, "' (", model_.id,
                        "), whose vectors cannot be compared with those of '", path, "' (", id, ")");
}

MOTIONLANG_BODY void MotionIndex::add(EncodedClip c) {
  const auto rows = [&](const std::vector<float>& values, std::size_t wanted) {
    if (values.size() != wanted * static_cast<std::size_t>(model_.width))
      raise<shape_error>(205, "MotionIndex: '", c.clip.path, "': ", counted(values.size(), "number"), " for ",
                         counted(wanted, "vector"), " of ", model_.width);
    return unit_rows(values, model_.width);
  };
  for (const FrameSlice& m : c.moments) {
    if (!is_moment(m))
      raise<shape_error>(205, "MotionIndex: '", c.clip.path, "': a moment of ", counted(m.length, "frame"), " at ",
                         m.first);
  }
  const auto clip = rows(c.vector, 1), moments = rows(c.moment_vectors, c.moments.size()),
             captions = rows(c.caption_vectors, c.clip.captions.size());
  clip_rows_.append(clip), moment_rows_.append(moments), caption_rows_.append(captions);
  for (const FrameSlice& m : c.moments) moments_.push_back({count(), m});
  caption_clips_.insert(caption_clips_.end(), c.clip.captions.size(), count());
  clips_.push_back(std::move(c.clip));
}

MOTIONLANG_BODY void MotionIndex::rename(const std::string& from, const std::string& to) {
  for (IndexedClip& c : clips_) {
    if (c.path == from) c.path = to;
  }
}

MOTIONLANG_BODY void MotionIndex::set_license(const std::string& path, const std::string& license) {
  for (IndexedClip& c : clips_) {
    if (c.path == path) c.license = license;
  }
}

MOTIONLANG_BODY void MotionIndex::move_model(std::string path, std::string text_encoder) {
  model_.path = std::move(path), model_.text_encoder = std::move(text_encoder);
}

MOTIONLANG_BODY std::span<const float> MotionIndex::row(const VectorTable& table, std::size_t i) const {
  const auto width = static_cast<std::size_t>(model_.width);
  return table.rows().subspan(i * width, width);
}

MOTIONLANG_BODY void MotionIndex::require_rows(std::string_view where, std::string_view what, std::size_t count,
                                               const VectorTable& table) const {
  if (table.rows().size() != count * static_cast<std::size_t>(model_.width))
    raise<io_error>(403, where, ": ", count, " ", what, ", but ", counted(table.rows().size(), "number"),
                    " for vectors of ", model_.width);
  require_unit_rows(where, table.rows(), model_.width);
}

MOTIONLANG_NAMESPACE_END
