// SPDX-License-Identifier: MIT
/// Makes HumanML3D from AMASS, as its three notebooks do: joints of the user's body models, mirrored copies, features,
/// and statistics. A stopped run goes on where it was: clips that exist are not made again. Other options need another
/// folder.
///
///     const auto made = make_humanml3d<EigenBackend<float>>({.repository = "HumanML3D", .amass = "AMASS",
///                                                            .bodies = "body_models"}, "data/HumanML3D");
///
/// Repository  a checkout of github.com/EricGuo5513/HumanML3D with its archives unpacked: index.csv,
///             HumanML3D/texts/*.txt and the lists beside them, pose_data/humanact12
/// AMASS       the files of SMPL+H, of any release (amass_releases.hpp)
/// Source      Guo et al. (CVPR 2022), HumanML3D raw_pose_processing.ipynb, motion_representation.ipynb and
///             cal_mean_variance.ipynb
/// Differs     sums of the statistics are double. A caption of a mirrored clip that has no file is the mirrored caption
#pragma once

#include <filesystem>  // folders
#include <functional>  // clips
#include <string>      // ids
#include <utility>     // joints
#include <vector>      // joints

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/datasets/left_out.hpp>
#include <motionlang/features/guoh3d_extraction.hpp>
#include <motionlang/formats/amass_sequence.hpp>
#include <motionlang/formats/body_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct HumanMl3dSources {
  std::filesystem::path repository;  // with index.csv
  std::filesystem::path amass;
  std::filesystem::path bodies;  // SMPL-H, male and female (find_body_file)
};

struct HumanMl3dMaking {
  bool mirrored = true;      // also makes the clips whose names begin with M
  bool missing = false;      // leaves out clips whose source is missing; otherwise that is an error, before the work
  Guoh3dOptions features{};  // as published
};

struct MadeHumanMl3d {
  Index made = 0;         // clips, mirrored ones as well
  Index there = 0;        // clips that existed
  Index not_finite = 0;   // clips with NaN, which the statistics leave out, as published
  Index captionless = 0;  // clips that were made and have no captions
  LeftOut left_out{};     // clips that could not be made, and why
};

namespace detail {

/// A row of index.csv and its file.
struct PlacedSource {
  HumanMl3dSource row;
  std::string id;
  std::filesystem::path file;  // empty if it is missing
};

/// Rows whose file is missing have none, or are reported in one io_error 401.
std::vector<PlacedSource> placed_sources(const HumanMl3dSources& sources, bool missing);

/// Writes into a new folder how its features are made, and compares that in an old one. Throws config_error 102.
void require_same_making(const std::filesystem::path& out, const HumanMl3dMaking& making);

/// True if the clip, and its mirrored copy if wanted, have all their files.
bool has_humanml3d_clips(const std::filesystem::path& out, const std::string& id, bool mirrored);

/// The clip of these joints, (frames, 22), and its mirrored copy. Captions are those that have no file.
std::vector<HumanMl3dClip> humanml3d_clips(const HumanMl3dSources& sources, const std::string& id,
                                           std::span<const Vec3<double>> joints, const HumanMl3dMaking& making);

/// Writes a clip and the published file of its captions. Returns false if it has no captions.
bool write_made_clip(const HumanMl3dSources& sources, const std::filesystem::path& out, const HumanMl3dClip& clip);

/// Lists of ids and statistics over all clips of the index that exist.
void finish_humanml3d(const HumanMl3dSources& sources, const std::filesystem::path& out,
                      std::span<const PlacedSource> rows, bool mirrored, MadeHumanMl3d& made);

/// Writes the clips that `make` returns for a row, for all rows on several threads. What `make` throws is a reason to
/// leave the row out. A file that cannot be written stops the work.
void make_rows(const HumanMl3dSources& sources, std::span<const PlacedSource> rows, const std::filesystem::path& out,
               bool mirrored, const std::function<std::vector<HumanMl3dClip>(const PlacedSource&)>& make,
               MadeHumanMl3d& made, Progress progress);

/// The joints of a clip of HumanAct12, (frames, 24) or more, and their number in a frame.
std::pair<std::vector<Vec3<double>>, Index> humanact12_joints(const std::filesystem::path& npy);

}  // namespace detail

/// progress  counts the rows of index.csv; false stops the work with `cancelled`, and clips that were made stay
/// Throws    io_error 401 if the texts are missing, or a source and `missing` is not set; what read_humanml3d_index,
///           find_body_file and read_body throw; 401 if a file cannot be written; config_error 102 if clips in `out`
///           were made with other options
template <Backend B>
MadeHumanMl3d make_humanml3d(const HumanMl3dSources& sources, const std::filesystem::path& out,
                             const HumanMl3dMaking& making = {}, Progress progress = {}) {
  const auto rows = detail::placed_sources(sources, making.missing);
  detail::require_same_making(out, making);
  const auto body = [&](BodyGender gender) {
    return read_body<B>(find_body_file(FilePath(sources.bodies), BodyKind::smplh, gender),
                        {.betas = 10, .extra_points = false});
  };
  const Body<B> male = body(BodyGender::male), female = body(BodyGender::female);
  const auto joints_of = [&](const detail::PlacedSource& source) {
    std::vector<Vec3<double>> joints;
    const auto add = [&](const auto& posed) {
      for (const auto& p : posed)
        joints.push_back({static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)});
    };
    if (is_humanact12(source.row.source_path)) {
      const auto [recorded, count] = detail::humanact12_joints(source.file);
      const auto pose = [&, &all = recorded, n = count](std::span<const Index> numbers) {
        std::vector<Vec3<double>> some;
        for (const Index k : numbers) some.insert(some.end(), all.begin() + k * n, all.begin() + (k + 1) * n);
        return some;
      };
      add(humanml3d_source_joints<double>(source.row, std::ssize(recorded) / count, 20, pose));
    } else {
      const AmassSequence sequence = read_amass_sequence(FilePath(source.file));
      const BodyModel<B>& model = (humanml3d_uses_male_body(sequence.gender) ? male : female).model;
      add(humanml3d_source_joints<typename B::scalar>(
          source.row, sequence.frames, sequence.fps,
          [&](std::span<const Index> numbers) { return posed_joints(model, sequence, numbers); }));
    }
    return joints;
  };
  MadeHumanMl3d made;
  detail::make_rows(
      sources, rows, out, making.mirrored,
      [&](const detail::PlacedSource& source) {
        return detail::humanml3d_clips(sources, source.id, joints_of(source), making);
      },
      made, progress);
  detail::finish_humanml3d(sources, out, rows, making.mirrored, made);
  return made;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/make_humanml3d.ipp>
#endif
