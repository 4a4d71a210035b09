// SPDX-License-Identifier: MIT
// Bodies of humanml3d_folder.hpp.
#pragma once

#include <algorithm>  // all_of
#include <cmath>      // isfinite

#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/file/npy.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool HumanMl3dClip::is_finite() const {
  auto finite = [](float x) { return std::isfinite(x); };
  return std::all_of(features.begin(), features.end(), finite) && std::all_of(joints.begin(), joints.end(), finite);
}

namespace detail {

inline FilePath below(const FilePath& folder, std::string_view name) { return concat_text(folder.string(), "/", name); }

MOTIONLANG_BODY std::vector<float> read_rows(const FilePath& path, std::vector<Index> shape, bool any_number) {
  const NpyArray array = read_npy(path);
  if (any_number && !array.shape.empty()) shape.insert(shape.begin(), array.shape[0]);
  if (array.shape != shape) {
    raise<io_error>(407, path.string(), ": an array ", shape_text(array.shape), ", expected ", shape_text(shape));
  }
  return array.to<float>();
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::string> HumanMl3dFolder::ids(std::string_view split) const {
  return read_ids(detail::below(folder_, concat_text(split, ".txt")));
}

MOTIONLANG_BODY HumanMl3dClip HumanMl3dFolder::load(const std::string& id) const {
  HumanMl3dClip clip{id, 0, features(id), joints(id), captions(id)};
  clip.frames = std::ssize(clip.features) / form_.width();
  const Index frames = std::ssize(clip.joints) / (3 * form_.joints);
  if (frames != clip.frames) {
    raise<io_error>(407, folder_.string(), ": clip '", id, "' has ", counted(clip.frames, "frame"), " of features and ",
                    frames, " of joints");
  }
  return clip;
}

MOTIONLANG_BODY std::vector<float> HumanMl3dFolder::features(const std::string& id) const {
  return detail::read_rows(file("new_joint_vecs", id, ".npy"), {form_.width()}, /*any_number=*/true);
}

MOTIONLANG_BODY std::vector<float> HumanMl3dFolder::joints(const std::string& id) const {
  return detail::read_rows(file("new_joints", id, ".npy"), {form_.joints, 3}, /*any_number=*/true);
}

MOTIONLANG_BODY std::vector<MotionCaption> HumanMl3dFolder::captions(const std::string& id) const {
  return read_captions(file("texts", id, ".txt"));
}

MOTIONLANG_BODY std::vector<float> HumanMl3dFolder::mean() const {
  return detail::read_rows(detail::below(folder_, "Mean.npy"), {form_.width()});
}

MOTIONLANG_BODY std::vector<float> HumanMl3dFolder::deviation() const {
  return detail::read_rows(detail::below(folder_, "Std.npy"), {form_.width()});
}

MOTIONLANG_BODY FilePath HumanMl3dFolder::file(std::string_view kind, const std::string& id,
                                               std::string_view extension) const {
  if (!detail::is_clip_id(id)) raise<io_error>(403, folder_.string(), ": '", id, "' is not an id of a clip");
  return detail::below(folder_, concat_text(kind, "/", id, extension));
}

MOTIONLANG_BODY std::vector<HumanMl3dItem> humanml3d_items(std::span<const MotionCaption> captions, Index frames,
                                                           const HumanMl3dForm& form) {
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

namespace detail {

MOTIONLANG_BODY void write_clip_files(const FilePath& folder, const HumanMl3dClip& clip, std::string_view captions,
                                      const HumanMl3dForm& form) {
  if (!is_clip_id(clip.id) || clip.id.find('/') != clip.id.npos)
    raise<io_error>(403, folder.string(), ": '", clip.id, "' is not a name of a file");
  const auto features = NpyArray::of(std::span<const float>(clip.features), {clip.frames, form.width()});
  const auto joints = NpyArray::of(std::span<const float>(clip.joints), {clip.frames, form.joints, 3});
  auto file = [&](std::string_view kind, std::string_view extension) {
    make_folder(folder);
    make_folder(below(folder, kind));
    return below(folder, concat_text(kind, "/", clip.id, extension));
  };
  write_npy(file("new_joint_vecs", ".npy"), features);
  write_npy(file("new_joints", ".npy"), joints);
  write_file(file("texts", ".txt"), captions);
}

}  // namespace detail

MOTIONLANG_BODY void write_humanml3d_clip(const FilePath& folder, const HumanMl3dClip& clip,
                                          const HumanMl3dForm& form) {
  const FilePath texts = detail::below(folder, concat_text("texts/", clip.id, ".txt"));
  detail::write_clip_files(folder, clip, format_captions(clip.captions, texts.string()), form);
}

MOTIONLANG_BODY void write_humanml3d_statistics(const FilePath& folder, std::span<const float> mean,
                                                std::span<const float> deviation, const HumanMl3dForm& form) {
  const auto m = NpyArray::of(mean, {form.width()}), s = NpyArray::of(deviation, {form.width()});
  make_folder(folder);
  write_npy(detail::below(folder, "Mean.npy"), m);
  write_npy(detail::below(folder, "Std.npy"), s);
}

MOTIONLANG_NAMESPACE_END
