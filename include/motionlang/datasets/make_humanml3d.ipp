// SPDX-License-Identifier: MIT
// Bodies of make_humanml3d.hpp.
#pragma once

#include <algorithm>  // find
#include <optional>   // failures

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
    if (part == "..") raise<io_error>(403, "index.csv: the path '", source_path, "' leads out of its folder");
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

MOTIONLANG_BODY std::vector<PlacedSource> placed_sources(const HumanMl3dSources& sources, bool missing) {
  const auto texts = sources.repository / "HumanML3D" / "texts";
  if (!std::filesystem::is_directory(texts))
    raise<io_error>(401, texts.string(), " is missing: unpack HumanML3D/texts.zip of the repository there");
  std::vector<PlacedSource> out;
  std::vector<std::string> without;
  for (HumanMl3dSource& row : read_humanml3d_index(FilePath(sources.repository / "index.csv"))) {
    std::string id = std::filesystem::path(row.new_name).stem().string();
    if (!is_clip_id(id)) raise<io_error>(403, "index.csv: '", row.new_name, "' cannot be the name of a clip");
    auto file = source_file(sources, row.source_path);
    if (file.empty()) without.push_back(row.source_path);
    out.push_back({std::move(row), std::move(id), std::move(file)});
  }
  if (!missing && !without.empty()) {
    constexpr std::size_t shown = 5;
    const std::size_t all = without.size();
    without.resize(std::min(all, shown));
    raise<io_error>(401, all, " of ", counted(out.size(), "source"), " of index.csv are missing below ",
                    sources.amass.string(), " and ", (sources.repository / "pose_data").string(), ", such as ",
                    join_text(without), "; `missing` leaves their clips out");
  }
  return out;
}

MOTIONLANG_BODY bool has_humanml3d_clips(const std::filesystem::path& out, const std::string& id, bool mirrored) {
  const auto whole = [&](const std::string& name) {
    return std::filesystem::exists(rows_file(out, name)) &&
           std::filesystem::exists(out / "new_joints" / (name + ".npy")) &&
           std::filesystem::exists(out / "texts" / (name + ".txt"));
  };
  return whole(id) && (!mirrored || whole(mirrored_id(id)));
}

MOTIONLANG_BODY bool write_humanml3d_clips(const HumanMl3dSources& sources, const std::filesystem::path& out,
                                           const std::string& id, std::span<const Vec3<double>> joints,
                                           const HumanMl3dMaking& making) {
  const ChainSkeleton& skeleton = humanml3d_chains();
  const auto texts = sources.repository / "HumanML3D" / "texts";
  const auto captions_of = [&](const std::string& name) {
    const auto file = texts / (name + ".txt");
    return std::filesystem::exists(file) ? read_captions(FilePath(file)) : std::vector<MotionCaption>();
  };
  auto captions = captions_of(id);
  const auto write = [&](const std::string& name, std::span<const Vec3<double>> clip, std::vector<MotionCaption> said) {
    const auto rows = guoh3d_features(skeleton, clip, making.features);
    auto made = humanml3d_clip_of_rows(name, {rows.begin(), rows.end()});
    made.captions = std::move(said);
    write_humanml3d_clip(FilePath(out), made);
  };
  write(id, joints, captions);
  if (making.mirrored) {
    auto said = captions_of(mirrored_id(id));
    if (said.empty()) {
      for (const MotionCaption& c : captions) said.push_back(motionlang::mirrored(c));
    }
    const auto partners = humanml3d_mirror_partners(static_cast<int>(skeleton.size()));
    const auto clip = mirror_joints(joints, std::span<const int>(partners));
    write(mirrored_id(id), clip, std::move(said));
  }
  return !captions.empty();
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

MOTIONLANG_BODY void make_rows(std::span<const PlacedSource> rows, const std::filesystem::path& out, bool mirrored,
                               const std::function<bool(const PlacedSource&)>& make, MadeHumanMl3d& made,
                               Progress progress) {
  struct Result {
    bool there = false, captions = true;
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
      } else if (source.file.empty()) {
        result.failure = "without their source";
      } else {
        guard<error>([&] { result.captions = make(source); },
                     [&](const error& e) {
                       result.failure = e.what();
                       return true;
                     });
      }
    });
    const Index clips = mirrored ? 2 : 1;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const Result& result = results[i];
      if (result.failure)
        made.left_out.add(*result.failure, some[i].id, clips);
      else
        (result.there ? made.there : made.made) += clips;
      if (!result.captions) made.captionless += clips;
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
