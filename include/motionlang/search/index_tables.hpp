// SPDX-License-Identifier: MIT
/// The clips, moments and captions of an index by their numbers, as a search asks for them. A MotionIndex has
/// them in memory, and IndexShards (search/index_shards.hpp) reads the few that are found.
#pragma once

#include <motionlang/search/motion_index.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Laws  numbers of clips, moments and captions count from 0, and moments and captions are in the order of their clips
class IndexTables {
 public:
  virtual ~IndexTables() = default;

  virtual const IndexModel& model() const = 0;
  virtual Index clip_count() const = 0;
  virtual Index moment_count() const = 0;
  virtual Index caption_count() const = 0;
  virtual IndexedClip clip(Index i) const = 0;
  virtual MotionIndex::Moment moment(Index i) const = 0;
  virtual Index clip_of_caption(Index i) const = 0;

 protected:
  IndexTables() = default;
  IndexTables(const IndexTables&) = default;
  IndexTables& operator=(const IndexTables&) = default;
};

/// Those of an index that outlives the object.
class TablesOfIndex : public IndexTables {
 public:
  explicit TablesOfIndex(const MotionIndex& index) : index_(index) {}

  const IndexModel& model() const override { return index_.model(); }
  Index clip_count() const override { return index_.count(); }
  Index moment_count() const override { return std::ssize(index_.moments()); }
  Index caption_count() const override { return std::ssize(index_.caption_clips()); }
  IndexedClip clip(Index i) const override { return index_.clips()[static_cast<std::size_t>(i)]; }
  MotionIndex::Moment moment(Index i) const override { return index_.moments()[static_cast<std::size_t>(i)]; }
  Index clip_of_caption(Index i) const override { return index_.caption_clips()[static_cast<std::size_t>(i)]; }

 private:
  const MotionIndex& index_;
};

MOTIONLANG_NAMESPACE_END
