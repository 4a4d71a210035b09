// SPDX-License-Identifier: MIT
// Bodies of make_humanml3d.hpp.
#pragma once

#include <algorithm>  // min
#include <optional>   // failures
#include <set>        // ids

#include <motionlang/core/parallel.hpp>
#include <motionlang/datasets/amass_releases.hpp>
#include <motionlang/datasets/data_set_form.hpp>
#include <motionlang/datasets/humanml3d_clip.hpp>
#include <motionlang/datasets/make_humanml3d.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/file/id_list.hpp>
#include <motionlang/kinematics/guo_chains.hpp>
#include <motionlang/kinematics/mirror_joints.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// "./pose_data/KIT/3/kick_poses.npy" -> AMASS/KIT/3/kick_poses.npz, under the names of any release. Empty if it is
/// missing.
inline std::filesystem::path source_file(const HumanMl3dSources& sources, const std::string& source_path) {
  namespace fs = std::filesystem;
  fs::path below;
  for (const fs::path& part : fs::path(source_path)) {
    if (part == ".." || part.has_root_path())
      raise<io_error>(403, "index.csv: the path '", source_path, "' leads out of its folder");
    if (part != "." && part != "pose_data") below /= part;
  }
  std::error_code ignored;
  if (is_humanact12(source_path)) {
    const fs::path file = sources.repository / "pose_data" / below;
    return fs::is_regular_file(file, ignored) ? file : fs::path();
  }
  for (const std::string& name : amass_paths(below.replace_extension(".npz").generic_string())) {
    if (fs::is_regular_file(sources.amass / name, ignored)) return sources.amass / name;
  }
  return {};
}

inline std::filesystem::path texts_of(const HumanMl3dSources& sources) {
  return sources.repository / "HumanML3D" / "texts";
}

MOTIONLANG_BODY std::vector<PlacedSource> placed_sources(const HumanMl3dSources& sources, bool missing) {
  const auto texts = texts_of(sources);
  if (!std::filesystem::is_directory(texts))
    raise<io_error>(401, texts.string(), " is missing: unpack HumanML3D/texts.zip of the repository there");
  std::vector<PlacedSource> out;
  std::vector<std::string> without;
  std::set<std::string> ids;
  for (HumanMl3dSource& row : read_humanml3d_index(FilePath(sources.repository / "index.csv"))) {
    std::string id = std::filesystem::path(row.new_name).stem().string();
    if (!is_clip_id(id)) raise<io_error>(403, "index.csv: '", row.new_name, "' cannot be the name of a clip");
    if (!ids.insert(id).second || !ids.insert(mirrored_id(id)).second)
      raise<io_error>(403, "index.csv: the clip '", id, "', or its mirrored copy, has two rows");
    auto file = source_file(sources, row.source_path);
    if (file.empty()) without.push_back(row.source_path);
    out.push_back({std::move(row), std::move(id), std::move(file)});
  }
  if (!missing && !without.empty()) {
    constexpr std::size_t shown = 5;
    const std::size_t all = without.size();
    without.resize(std::min(all, shown));
    raise<io_error>(401, all, " of ", counted(out.size(), "source"), " of index.csv are missing below ",
                    sources.amass.string(), " and in pose_data of ", sources.repository.string(), ", such as ",
                    join_text(without), "; `missing` leaves their clips out");
  }
  return out;
}

MOTIONLANG_BODY void require_same_making(const std::filesystem::path& out, const HumanMl3dMaking& making) {
  const Guoh3dOptions& f = making.features;
  const ChainRotationOptions& r = f.rotations;
  const std::string now = concat_text("sigma ", r.facing.sigma, ", legacy_forward ", r.facing.legacy_forward,
                                      ", fix_first_frame ", r.fix_first_frame, ", fix_opposite_bones ",
                                      r.fix_opposite_bones, ", fix_yaw_sign ", f.fix_yaw_sign, "\n");
  const auto file = out / "made_with.txt";
  if (std::filesystem::exists(file)) {
    if (const std::string before = read_file(FilePath(file)); before != now)
      raise<config_error>(102, file.string(), ": clips here were made with '", before.substr(0, before.find('\n')),
                          "', and now with '", now.substr(0, now.find('\n')), "'");
    return;
  }
  make_folder(FilePath(out));
  write_file(FilePath(file), now);
}

MOTIONLANG_BODY bool has_humanml3d_clips(const std::filesystem::path& out, const std::string& id, bool mirrored) {
  const auto whole = [&](const std::string& name) {
    return std::filesystem::exists(rows_file(out, name)) &&
           std::filesystem::exists(out / "new_joints" / (name + ".npy")) &&
           std::filesystem::exists(out / "texts" / (name + ".txt"));
  };
  return whole(id) && (!mirrored || whole(mirrored_id(id)));
}

MOTIONLANG_BODY std::vector<HumanMl3dClip> humanml3d_clips(const HumanMl3dSources& sources, const std::string& id,
                                                           std::span<const Vec3<double>> joints,
                                                           const HumanMl3dMaking& making) {
  const ChainSkeleton& skeleton = humanml3d_chains();
  const auto clip_of = [&](const std::string& name, std::span<const Vec3<double>> clip) {
    const auto rows = guoh3d_features(skeleton, clip, making.features);
    return humanml3d_clip_of_rows(name, {rows.begin(), rows.end()});
  };
  std::vector<HumanMl3dClip> out;
  out.push_back(clip_of(id, joints));
  if (!making.mirrored) return out;
  const auto partners = humanml3d_mirror_partners(static_cast<int>(skeleton.size()));
  out.push_back(clip_of(mirrored_id(id), mirror_joints(joints, std::span<const int>(partners))));
  const auto texts = texts_of(sources);
  const auto file = texts / (id + ".txt");
  if (std::filesystem::exists(file) && !std::filesystem::exists(texts / (mirrored_id(id) + ".txt"))) {
    for (const MotionCaption& c : read_captions(FilePath(file))) out.back().captions.push_back(mirrored(c));
  }
  return out;
}

MOTIONLANG_BODY bool write_made_clip(const HumanMl3dSources& sources, const std::filesystem::path& out,
                                     const HumanMl3dClip& clip) {
  const auto file = texts_of(sources) / (clip.id + ".txt");
  if (!std::filesystem::exists(file)) {
    write_humanml3d_clip(FilePath(out), clip);
    return !clip.captions.empty();
  }
  const std::string said = read_file(FilePath(file));  // as it is, like the notebooks
  detail::write_clip_files(FilePath(out), clip, said);
  return !said.empty();
}

MOTIONLANG_BODY std::pair<std::vector<Vec3<double>>, Index> humanact12_joints(const std::filesystem::path& npy) {
  const NpyArray array = read_npy(FilePath(npy));
  if (array.shape.size() != 3 || array.shape[2] != 3 || array.shape[1] < 22)
    raise<io_error>(407, npy.string(), " has the shape ", join_text(array.shape, " x "), ", expected frames x 24 x 3");
  const auto values = array.to<double>();
  std::vector<Vec3<double>> out;
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) out.push_back({values[i], values[i + 1], values[i + 2]});
  return {std::move(out), array.shape[1]};
}

MOTIONLANG_BODY void make_rows(const HumanMl3dSources& sources, std::span<const PlacedSource> rows,
                               const std::filesystem::path& out, bool mirrored,
                               const std::function<std::vector<HumanMl3dClip>(const PlacedSource&)>& make,
                               MadeHumanMl3d& made, Progress progress) {
  struct Result {
    bool there = false;
    Index captionless = 0;
    std::optional<std::string> failure{};
  };
  constexpr Index together = 32;
  for (Index first = 0; first < std::ssize(rows); first += together) {
    const auto some = rows.subspan(static_cast<std::size_t>(first),
                                   static_cast<std::size_t>(std::min(together, std::ssize(rows) - first)));
    std::vector<Result> results(some.size());
    parallel_for(std::ssize(some), [&](Index i) {
      const PlacedSource& source = some[static_cast<std::size_t>(i)];
      Result& result = results[static_cast<std::size_t>(i)];
      if (has_humanml3d_clips(out, source.id, mirrored)) {
        result.there = true;
        return;
      }
      if (source.file.empty()) {
        result.failure = "without their source";
        return;
      }
      std::vector<HumanMl3dClip> clips;
      guard<error>([&] { clips = make(source); },
                   [&](const error& e) {
                     result.failure = e.what();
                     return true;
                   });
      for (const HumanMl3dClip& clip : clips) result.captionless += write_made_clip(sources, out, clip) ? 0 : 1;
    });
    const Index clips = mirrored ? 2 : 1;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const Result& result = results[i];
      if (result.failure)
        made.left_out.add(*result.failure, some[i].id, clips);
      else
        (result.there ? made.there : made.made) += clips;
      made.captionless += result.captionless;
    }
    progress(first + std::ssize(some), std::ssize(rows));
  }
}

MOTIONLANG_BODY void finish_humanml3d(const HumanMl3dSources& sources, const std::filesystem::path& out,
                                      std::span<const PlacedSource> rows, bool mirrored, MadeHumanMl3d& made) {
  std::vector<std::string> ids;
  for (const bool copies : {false, true}) {
    for (const PlacedSource& source : rows) {
      const std::string id = copies ? mirrored_id(source.id) : source.id;
      if ((mirrored || !copies) && std::filesystem::exists(rows_file(out, id))) ids.push_back(id);
    }
  }
  FeatureStatistics statistics;
  const HumanMl3dFolder folder{FilePath(out)};
  const Guoh3dSlots slots{folder.form().joints};
  for (const std::string& id : ids) {
    const auto values = folder.features(id);
    if (!statistics.add_finite(std::span<const float>(values), slots.size())) ++made.not_finite;
  }
  if (statistics.count() > 0) {
    const auto deviation = group_means(statistics.population_deviation(), slots.groups());
    const std::vector<float> mean(statistics.mean().begin(), statistics.mean().end());
    write_humanml3d_statistics(FilePath(out), mean, std::vector<float>(deviation.begin(), deviation.end()));
  }
  for (const char* name : {"train", "val", "test", "train_val", "all"}) {
    const auto list = sources.repository / "HumanML3D" / concat_text(name, ".txt");
    std::vector<std::string> kept;
    if (std::filesystem::exists(list)) {
      for (std::string& id : read_ids(FilePath(list))) {
        if (std::filesystem::exists(rows_file(out, id))) kept.push_back(std::move(id));
      }
    } else if (std::string_view(name) == "all") {
      kept = ids;
    } else {
      continue;
    }
    write_ids(FilePath(out / concat_text(name, ".txt")), kept);
  }
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
