// SPDX-License-Identifier: MIT
/// Data sets in the form of HumanML3D, which KIT-ML and most own data take, too: read clip by clip, and written.
///
///     new_joint_vecs/<id>.npy  (N, 263) float32        texts/<id>.txt      captions (humanml3d_texts.hpp)
///     new_joints/<id>.npy      (N, 22, 3) float32      Mean.npy, Std.npy   (263) float32
///     train.txt, val.txt, test.txt, train_val.txt, all.txt    ids, of mirrored clips with an M in front
///
///     const HumanMl3dFolder data("HumanML3D");
///     for (const std::string& id : data.ids("train")) use(data.load(id));
///
/// Source  Guo et al. (CVPR 2022); spec humanml3d-features.md 10, exchange-formats.md 5.2
#pragma once

#include <motionlang/datasets/humanml3d_texts.hpp>
#include <motionlang/features/layout.hpp>
#include <motionlang/file/npy.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// What tells the data sets apart. Captions are cut at 20 frames per second in both, as published.
struct HumanMl3dForm {
  Index joints = 22;
  double fps = 20;
  Index shortest = 40, longest = 199;  // frames of a clip that the published loaders keep

  Index width() const { return Guoh3dSlots{joints}.size(); }
};
inline constexpr HumanMl3dForm humanml3d_form{}, kit_ml_form{21, 12.5, 24, 199};

struct HumanMl3dClip {
  std::string id;
  Index frames = 0;
  std::vector<float> features;  // (frames, 12 J - 1)
  std::vector<float> joints;    // (frames, J, 3)
  std::vector<MotionCaption> captions;
  bool operator==(const HumanMl3dClip&) const = default;

  /// The published set has clips with NaN (007975 and its mirror).
  bool is_finite() const {
    auto finite = [](float x) { return std::isfinite(x); };
    return std::all_of(features.begin(), features.end(), finite) && std::all_of(joints.begin(), joints.end(), finite);
  }
};

namespace detail {

inline FilePath below(const FilePath& folder, std::string_view name) { return concat_text(folder.string(), "/", name); }

/// The values of an array of this shape, or of any number of rows of it. Throws io_error 407 for another shape.
inline std::vector<float> read_rows(const FilePath& path, std::vector<Index> shape, bool any_number = false) {
  const NpyArray array = read_npy(path);
  if (any_number && !array.shape.empty()) shape.insert(shape.begin(), array.shape[0]);
  if (array.shape != shape) {
    raise<io_error>(407, path.string(), ": an array ", shape_text(array.shape), ", expected ", shape_text(shape));
  }
  return array.to<float>();
}

}  // namespace detail

/// A folder that is being read. Nothing is kept in memory: every call reads its files.
class HumanMl3dFolder {
 public:
  explicit HumanMl3dFolder(FilePath folder, const HumanMl3dForm& form = {}) : folder_(std::move(folder)), form_(form) {}

  const HumanMl3dForm& form() const { return form_; }
  /// The ids of <split>.txt. Throws io_error 401, 403.
  std::vector<std::string> ids(std::string_view split = "all") const {
    return read_ids(detail::below(folder_, concat_text(split, ".txt")));
  }
  /// Features, joints and captions. Throws io_error 401 to 405 as read_npy, 403 as read_captions, 407 for arrays of
  /// another shape and for features and joints of different lengths.
  HumanMl3dClip load(const std::string& id) const {
    HumanMl3dClip clip{id, 0, features(id), joints(id), captions(id)};
    clip.frames = std::ssize(clip.features) / form_.width();
    const Index frames = std::ssize(clip.joints) / (3 * form_.joints);
    if (frames != clip.frames) {
      raise<io_error>(407, folder_.string(), ": clip '", id, "' has ", counted(clip.frames, "frame"),
                      " of features and ", frames, " of joints");
    }
    return clip;
  }
  /// (frames, 12 J - 1). Throws io_error 401 to 405, 407.
  std::vector<float> features(const std::string& id) const {
    return detail::read_rows(file("new_joint_vecs", id, ".npy"), {form_.width()}, /*any_number=*/true);
  }
  /// (frames, J, 3). Throws io_error 401 to 405, 407.
  std::vector<float> joints(const std::string& id) const {
    return detail::read_rows(file("new_joints", id, ".npy"), {form_.joints, 3}, /*any_number=*/true);
  }
  /// Throws io_error 401, 403.
  std::vector<MotionCaption> captions(const std::string& id) const { return read_captions(file("texts", id, ".txt")); }

  /// (12 J - 1). Throws io_error 401 to 405, 407.
  std::vector<float> mean() const { return detail::read_rows(detail::below(folder_, "Mean.npy"), {form_.width()}); }
  std::vector<float> deviation() const { return detail::read_rows(detail::below(folder_, "Std.npy"), {form_.width()}); }

 private:
  /// Throws io_error 403 for an id that leads out of the folder.
  FilePath file(std::string_view kind, const std::string& id, std::string_view extension) const {
    if (!detail::is_clip_id(id)) raise<io_error>(403, folder_.string(), ": '", id, "' is no id of a clip");
    return detail::below(folder_, concat_text(kind, "/", id, extension));
  }

  FilePath folder_;
  HumanMl3dForm form_;
};

/// What the published loaders make of a clip: one item of the whole clip with the captions of all of it, and one for
/// each caption with times of its own.
struct HumanMl3dItem {
  FrameSlice frames;
  std::vector<std::size_t> captions;  // numbers among those of the clip
  bool operator==(const HumanMl3dItem&) const = default;
};
/// Items of a length that the loaders keep; none if the clip itself is too short or too long. Seconds count at 20
/// frames per second, for KIT-ML too, as published.
inline std::vector<HumanMl3dItem> humanml3d_items(std::span<const MotionCaption> captions, Index frames,
                                                  const HumanMl3dForm& form = {}) {
  auto kept = [&](Index length) { return length >= form.shortest && length <= form.longest; };
  std::vector<HumanMl3dItem> items;
  if (!kept(frames)) return items;
  HumanMl3dItem whole{{0, frames}, {}};
  for (std::size_t i = 0; i < captions.size(); ++i) {
    const MotionCaption& c = captions[i];
    const FrameSlice slice = c.of_whole_clip() ? FrameSlice{} : slice_of_seconds(c.start, c.end, 20, frames);
    if (c.of_whole_clip())
      whole.captions.push_back(i);
    else if (kept(slice.length))
      items.push_back({slice, {i}});
  }
  if (!whole.captions.empty()) items.push_back(std::move(whole));
  return items;
}

/// Writes the files of a clip, captions last, and makes the folders that are missing. Write the lists of ids
/// (write_ids) when all clips are there: a list then names no clip that is not whole.
/// Throws io_error 401, 403 for an id that leads out of the folder, shape_error 205 if the values do not fit the form,
/// timeline_error 510 as format_captions
inline void write_humanml3d_clip(const FilePath& folder, const HumanMl3dClip& clip, const HumanMl3dForm& form = {}) {
  if (!detail::is_clip_id(clip.id) || clip.id.find('/') != clip.id.npos)
    raise<io_error>(403, folder.string(), ": '", clip.id, "' is no name of a file");
  const FilePath texts = detail::below(folder, concat_text("texts/", clip.id, ".txt"));
  const std::string captions = format_captions(clip.captions, texts.string());
  const auto features = NpyArray::of(std::span<const float>(clip.features), {clip.frames, form.width()});
  const auto joints = NpyArray::of(std::span<const float>(clip.joints), {clip.frames, form.joints, 3});
  auto file = [&](std::string_view kind, std::string_view extension) {
    make_folder(folder);
    make_folder(detail::below(folder, kind));
    return detail::below(folder, concat_text(kind, "/", clip.id, extension));
  };
  write_npy(file("new_joint_vecs", ".npy"), features);
  write_npy(file("new_joints", ".npy"), joints);
  write_file(file("texts", ".txt"), captions);
}
/// Mean.npy and Std.npy, of FeatureStatistics for instance. Throws io_error 401, shape_error 205 for another width.
inline void write_humanml3d_statistics(const FilePath& folder, std::span<const float> mean,
                                       std::span<const float> deviation, const HumanMl3dForm& form = {}) {
  const auto m = NpyArray::of(mean, {form.width()}), s = NpyArray::of(deviation, {form.width()});
  make_folder(folder);
  write_npy(detail::below(folder, "Mean.npy"), m);
  write_npy(detail::below(folder, "Std.npy"), s);
}

MOTIONLANG_NAMESPACE_END
