// SPDX-License-Identifier: MIT
// Bodies of humanml3d_clip.hpp.
#pragma once

#include <algorithm>  // find

#include <motionlang/datasets/humanml3d_clip.hpp>
#include <motionlang/features/guoh3d.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/formats/features_npy.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY HumanMl3dClip humanml3d_clip_of_rows(const std::string& id, std::vector<float> rows,
                                                     const HumanMl3dForm& form) {
  HumanMl3dClip clip{id, std::ssize(rows) / form.width(), std::move(rows), {}, {}};
  const std::vector<double> values(clip.features.begin(), clip.features.end());
  for (const auto& p : guoh3d_joints(std::span<const double>(values), form.joints)) {
    for (const double x : {p.x, p.y, p.z}) clip.joints.push_back(static_cast<float>(x));
  }
  return clip;
}

MOTIONLANG_BODY AddedClip add_humanml3d_clip(const std::filesystem::path& folder, const std::string& id,
                                             const Motion& motion, const DataSetForm& form, double fps, bool replace) {
  const auto list = folder / "all.txt";
  auto ids = std::filesystem::exists(list) ? read_ids(list) : std::vector<std::string>{};
  auto other = ids.empty() ? std::filesystem::path() : rows_file(folder, ids.front());
  if (!std::filesystem::exists(other) && is_data_set(folder)) {
    const std::filesystem::directory_iterator entries(folder / "new_joint_vecs");
    if (entries != std::filesystem::directory_iterator()) other = entries->path();
  }
  if (std::filesystem::exists(other)) {
    if (const DataSetForm& is = data_set_form_of(other); is.features != form.features)
      raise<config_error>(102, other.string(), ": rows of ", counted(is.form.width(), "number"), " (", is.features,
                          "), the new clip has rows of ", form.form.width(), " (", form.features, ")");
  }
  FeatureRows made = feature_rows(motion, motion_features(form.features), fps);
  if (const auto there = rows_file(folder, id);
      !replace && std::filesystem::exists(there) && read_npy(there).to<float>() != made.values)
    raise<config_error>(102, there.string(), ": the clip '", id,
                        "' exists already with another motion; `replace` overwrites it");
  HumanMl3dClip clip = humanml3d_clip_of_rows(id, std::move(made.values), form.form);
  if (std::filesystem::exists(folder / "texts" / (id + ".txt"))) clip.captions = HumanMl3dFolder(folder).captions(id);
  write_humanml3d_clip(folder, clip, form.form);
  if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  write_ids(list, ids);
  return {clip.frames, made.fps, clip.captions.size()};
}

MOTIONLANG_NAMESPACE_END
