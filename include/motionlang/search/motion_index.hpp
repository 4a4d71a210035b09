// SPDX-License-Identifier: MIT
/// A searchable collection of clips, as vectors of a model that knows texts and motions. There is one vector for each
/// clip, for each of its moments (windows over its frames) and for each of its captions. search/motion_index_file.hpp
/// reads and writes it, and motion_search.hpp searches it.
#pragma once

#include <cstdint>  // times of files
#include <memory>   // owner of mapped rows
#include <string>   // paths

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/search/unit_rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The source of the vectors.
struct IndexModel {
  std::string id;                // of the weights: vectors of different models cannot be compared
  std::string path;              // of the model, to find it again
  std::string text_encoder{};    // text encoder beside the model, "" if none
  Index width = 0;               // of a vector
  double fps = 0;                // frames per second of the model
  std::vector<Index> windows{};  // lengths of moments in such frames; none: only whole clips
  Index stride = 0;              // frames from one moment to the next
  bool operator==(const IndexModel&) const = default;
};

/// A clip: a file of motion, one of several motions in it, or a part of it.
struct IndexedClip {
  std::string path;                      // of the file
  std::string name{};                    // of the motion in the file, if there are several
  std::int64_t modified = 0, bytes = 0;  // of the file when it was read: nanoseconds, size
  std::string content{};      // checksum of the file then, which recognises it under another name; "" in old indices
  std::string lines{};        // checksum of the table lines that cut the file into clips; "" if none did
  double start = 0, end = 0;  // seconds in the file
  double fps = 0;             // of the file
  Index frames = 0;           // from start to end, in the file
  std::vector<std::string> captions{};
  std::string license{};
  bool operator==(const IndexedClip&) const = default;
};

/// A clip with its vectors, which may have any length except 0.
struct EncodedClip {
  IndexedClip clip;
  std::vector<float> vector;             // (width)
  std::vector<FrameSlice> moments{};     // in frames of the model, from the start of the clip
  std::vector<float> moment_vectors{};   // (moments, width)
  std::vector<float> caption_vectors{};  // (captions, width); or none
};

/// Rows in memory of their own or in a mapped file.
class VectorTable {
 public:
  VectorTable() = default;
  VectorTable(std::span<const float> mapped, std::shared_ptr<const void> owner)
      : mapped_(mapped), owner_(std::move(owner)) {}

  std::span<const float> rows() const { return owner_ == nullptr ? std::span<const float>(own_) : mapped_; }
  void append(std::span<const float> rows) {
    if (owner_ != nullptr) {
      own_.assign(mapped_.begin(), mapped_.end());
      owner_.reset();
    }
    own_.insert(own_.end(), rows.begin(), rows.end());
  }

 private:
  std::vector<float> own_;
  std::span<const float> mapped_;
  std::shared_ptr<const void> owner_;
};

class MotionIndex {
 public:
  struct Moment {
    Index clip = 0;
    FrameSlice frames;
    bool operator==(const Moment&) const = default;
  };

  /// An index without clips. Throws config_error 101 for sizes and rates that are not positive.
  explicit MotionIndex(IndexModel model);
  /// From the tables of a file, with rows of length 1. Throws io_error 403 if they do not fit each other, numeric_error
  /// 302.
  MotionIndex(std::string_view where, IndexModel model, std::vector<IndexedClip> clips, std::vector<Moment> moments,
              VectorTable clip_rows, VectorTable moment_rows, VectorTable caption_rows);

  const IndexModel& model() const { return model_; }
  Index count() const { return std::ssize(clips_); }
  std::span<const IndexedClip> clips() const { return clips_; }
  /// In the order of their clips.
  std::span<const Moment> moments() const { return moments_; }
  /// The clip of every caption, in order.
  std::span<const Index> caption_clips() const { return caption_clips_; }
  /// Rows of length 1: (clips, width), (moments, width), (captions, width).
  std::span<const float> clip_rows() const { return clip_rows_.rows(); }
  std::span<const float> moment_rows() const { return moment_rows_.rows(); }
  std::span<const float> caption_rows() const { return caption_rows_.rows(); }

  /// Throws config_error 102 if vectors of that model cannot be compared with those of the index.
  void require_model(std::string_view id, std::string_view path) const;
  /// Adds a clip at the end. Throws shape_error 205 if the vectors do not fit or a moment is invalid, and numeric_error
  /// 301, 302 (unit_rows); then nothing has changed.
  void add(EncodedClip c);
  /// Removes the clips for which f(clip) is true, with their moments and captions. Returns their number.
  template <class F>
  Index remove_if(F f) {
    std::vector<Index> number(clips_.size(), -1);  // of the remaining clips
    MotionIndex kept(model_);
    for (std::size_t i = 0; i < clips_.size(); ++i) {
      if (f(std::as_const(clips_[i]))) continue;
      number[i] = kept.count();
      kept.clip_rows_.append(row(clip_rows_, i));
      kept.clips_.push_back(std::move(clips_[i]));
    }
    const Index removed = count() - kept.count();
    for (std::size_t i = 0; i < moments_.size(); ++i) {
      const Index clip = number[static_cast<std::size_t>(moments_[i].clip)];
      if (clip < 0) continue;
      kept.moment_rows_.append(row(moment_rows_, i));
      kept.moments_.push_back({clip, moments_[i].frames});
    }
    for (std::size_t i = 0; i < caption_clips_.size(); ++i) {
      const Index clip = number[static_cast<std::size_t>(caption_clips_[i])];
      if (clip < 0) continue;
      kept.caption_rows_.append(row(caption_rows_, i));
      kept.caption_clips_.push_back(clip);
    }
    *this = std::move(kept);
    return removed;
  }
  /// Changes the path of a file.
  void rename(const std::string& from, const std::string& to);
  /// Sets the licence of all clips of a file.
  void set_license(const std::string& path, const std::string& license);
  /// Changes the place of the model.
  void move_model(std::string path, std::string text_encoder);

 private:
  /// True if it has frames, and an end that an Index can hold.
  static bool is_moment(const FrameSlice& m) {
    return m.first >= 0 && m.length >= 1 && m.first <= std::numeric_limits<Index>::max() - m.length;
  }
  std::span<const float> row(const VectorTable& table, std::size_t i) const;
  void require_rows(std::string_view where, std::string_view what, std::size_t count, const VectorTable& table) const;

  IndexModel model_;
  std::vector<IndexedClip> clips_;
  std::vector<Moment> moments_;
  std::vector<Index> caption_clips_;
  VectorTable clip_rows_, moment_rows_, caption_rows_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/motion_index.ipp>
#endif
