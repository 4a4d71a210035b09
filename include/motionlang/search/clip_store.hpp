// SPDX-License-Identifier: MIT
/// A collection of clips that an update changes: an index in memory (StoreOfIndex) or a folder of shards (ShardStore in
/// search/index_shards.hpp).
#pragma once

#include <vector>  // clips to remove

#include <motionlang/search/motion_index.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Laws  clips keep their order, and new ones come last
class ClipStore {
 public:
  virtual ~ClipStore() = default;

  virtual const IndexModel& model() const = 0;
  virtual std::span<const IndexedClip> clips() const = 0;
  virtual Index moment_count() const = 0;
  Index count() const { return std::ssize(clips()); }

  /// As MotionIndex has them.
  virtual void add(EncodedClip c) = 0;
  virtual void rename(const std::string& from, const std::string& to) = 0;
  virtual void set_license(const std::string& path, const std::string& license) = 0;
  virtual void move_model(std::string path, std::string text_encoder) = 0;
  /// gone  true for each clip that is removed, of all clips
  virtual void remove(const std::vector<bool>& gone) = 0;
  /// Removes the clips for which f(clip) is true. Returns their number.
  template <class F>
  Index remove_if(F f) {
    std::vector<bool> gone;
    Index removed = 0;
    for (const IndexedClip& c : clips()) {
      gone.push_back(f(c));
      removed += gone.back() ? 1 : 0;
    }
    if (removed > 0) remove(gone);
    return removed;
  }

 protected:
  ClipStore() = default;
  ClipStore(const ClipStore&) = default;
  ClipStore& operator=(const ClipStore&) = default;
};

/// An index that outlives the object.
class StoreOfIndex : public ClipStore {
 public:
  explicit StoreOfIndex(MotionIndex& index) : index_(index) {}

  const IndexModel& model() const override { return index_.model(); }
  std::span<const IndexedClip> clips() const override { return index_.clips(); }
  Index moment_count() const override { return std::ssize(index_.moments()); }
  void add(EncodedClip c) override { index_.add(std::move(c)); }
  void rename(const std::string& from, const std::string& to) override { index_.rename(from, to); }
  void set_license(const std::string& path, const std::string& license) override { index_.set_license(path, license); }
  void move_model(std::string path, std::string text_encoder) override {
    index_.move_model(std::move(path), std::move(text_encoder));
  }
  void remove(const std::vector<bool>& gone) override {
    std::size_t i = 0;
    index_.remove_if([&](const IndexedClip&) { return bool(gone[i++]); });
  }

 private:
  MotionIndex& index_;
};

MOTIONLANG_NAMESPACE_END
