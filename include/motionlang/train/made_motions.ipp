// SPDX-License-Identifier: MIT
// Bodies of made_motions.hpp.
#pragma once

#include <algorithm>  // all_of, sort, min
#include <array>      // extensions
#include <cmath>      // isfinite
#include <map>        // recorded motions

#include <motionlang/datasets/data_set_form.hpp>
#include <motionlang/features/feature_rows.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/train/made_motions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The motion files of a folder, sorted.
inline std::vector<std::filesystem::path> motion_files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  std::error_code problem;
  for (std::filesystem::directory_iterator at(folder, problem), end; !problem && at != end; at.increment(problem)) {
    if (is_motion_file(at->path()) && at->is_regular_file()) out.push_back(at->path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

MOTIONLANG_BODY std::vector<std::filesystem::path> made_files(const std::filesystem::path& folder,
                                                              const DescribedMotion& motion,
                                                              std::span<const char* const> kinds) {
  std::vector<std::filesystem::path> out;
  const auto add = [&](const std::string& name) {
    for (const char* kind : kinds) {
      const auto path = folder / (name + kind);
      if (!std::filesystem::exists(path)) continue;
      out.push_back(path);
      return true;
    }
    return false;
  };
  for (const std::string& id : {motion.id, motion.clip}) {
    if (!out.empty() || !is_clip_id(id)) continue;
    add(id);
    for (Index k = 0; add(concat_text(id, "_", k));) ++k;
  }
  return out;
}

MOTIONLANG_BODY void raise_not_made(const std::filesystem::path& folder, std::size_t motions, const LeftOut& missing) {
  raise<io_error>(401, folder.string(), ": a file is needed for each of ", counted(motions, "motion"), "; ",
                  missing.text());
}

MOTIONLANG_BODY std::string made_name(const std::filesystem::path& folder) {
  return (folder / "").parent_path().filename().string();
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::filesystem::path> MadeMotions::found(const DescribedMotion& motion) const {
  constexpr std::array kinds{".npy", ".npz", ".bvh", ".glb", ".vrma"};
  return detail::made_files(folder_, motion, kinds);
}

MOTIONLANG_BODY std::vector<std::filesystem::path> MadeMotions::files(const DescribedMotion& motion) const {
  auto out = found(motion);
  if (out.empty())
    raise<io_error>(401, folder_.string(), " has no ", motion.id, ".npy, .npz, .bvh, .glb or .vrma",
                    motion.clip == motion.id ? "" : ", also not as " + motion.clip);
  return out;
}

MOTIONLANG_BODY Index MadeMotions::samples(const std::vector<DescribedMotion>& part) const {
  LeftOut missing;
  Index count = 0, fewest = 0;
  for (const DescribedMotion& m : part) {
    const Index own = std::ssize(found(m));
    fewest = &m == &part.front() ? own : std::min(fewest, own);
    if (own > 0) continue;
    ++count;
    missing.add("without a file", m.id);
  }
  if (count > 0) detail::raise_not_made(folder_, part.size(), missing);
  return fewest;
}

MOTIONLANG_BODY MadeMotions::Rows MadeMotions::rows(const std::filesystem::path& file, const MotionFeatures& features,
                                                    double fps) const {
  const auto floats = [](const auto& values) { return std::vector<float>(values.begin(), values.end()); };
  if (file_kind(file.string()) == ".npy") {
    const auto shape = npy_shape(file);
    if (shape.size() == 2 && shape[1] == features.width) {
      Rows out{read_npy(file.string()).to<float>(), features.fps};
      if (out.rows.empty()) raise<io_error>(403, file.string(), ": no rows");
      if (!std::all_of(out.rows.begin(), out.rows.end(), [](float x) { return std::isfinite(x); }))
        raise<io_error>(403, file.string(), ": a number that is not finite");
      return out;
    }
  }
  const Motion motion = read_motion(file.string(), {.rate = rate_});
  return {floats(rows_of_motion(features, motion, fps)), fps};
}

MOTIONLANG_BODY std::vector<DescribedMotion> MadeMotions::of_actions(std::span<const std::string> labels,
                                                                     const RowMaker& maker) const {
  std::vector<DescribedMotion> out;
  for (const std::string& label : labels) {
    const auto files = detail::motion_files_in(folder_ / label);
    if (files.empty()) raise<io_error>(401, (folder_ / label).string(), ": no motions of '", label, "'");
    for (const auto& file : files) {
      const Motion motion = resample(on_smpl(read_motion(file.string(), {.rate = rate_})), maker.fps);
      const auto values = maker.rows(motion);
      DescribedMotion d{file.stem().string(), file.stem().string(), {values.begin(), values.end()}, {}};
      d.texts.push_back({label, {0, motion.frames()}});
      out.push_back(std::move(d));
    }
  }
  return out;
}

MOTIONLANG_BODY NamedErrors made_errors(const MadeMotions& made, const MotionFeatures& features,
                                        const DescribedMotions& data, const std::vector<DescribedMotion>& part,
                                        const TemosJoints& joints, double rate,
                                        std::span<const DescribedMotion> recorded) {
  const double compared = rate > 0 ? rate : data.fps;
  std::map<std::string, const DescribedMotion*> recorded_of;
  for (const DescribedMotion& motion : recorded) recorded_of.emplace(motion.id, &motion);
  const auto at_rate = [&](std::span<const float> rows, double fps) {
    return joints_at_rate(joints(rows), joints.variant.joints, fps, compared);
  };
  made.samples(part);
  JointErrors errors(joints.variant, joints.unit);
  for (const DescribedMotion& motion : part) {
    const auto known = recorded_of.find(motion.id);
    const JointFrames truth = known == recorded_of.end()
                                  ? at_rate(first_text_rows(motion, features.width), data.fps)
                                  : joints(rows_of_text(*known->second, motion.texts.front().text, features.width));
    const auto own = made.rows(made.files(motion).front(), features, compared);
    errors.add(at_rate(own.rows, own.fps), truth);
  }
  return {detail::made_name(made.folder()), errors.result()};
}

MOTIONLANG_NAMESPACE_END
