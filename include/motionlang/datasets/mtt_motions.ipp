// SPDX-License-Identifier: MIT
// Bodies of mtt_motions.hpp.
#pragma once

#include <algorithm>   // min
#include <cmath>       // abs
#include <filesystem>  // files
#include <optional>    // files that are not there

#include <motionlang/compose/detail/timeline_line.hpp>
#include <motionlang/datasets/mtt_motions.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/kinematics/mirror_joints.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/on_smpl.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr Index mtt_joints = 22;
inline constexpr double mtt_fps = 20;

/// The file of a path, by whatever extension.
inline std::optional<std::filesystem::path> mtt_file(const std::filesystem::path& folder, const std::string& path) {
  for (const char* extension : {"", ".npy", ".npz", ".bvh", ".glb"}) {
    const auto file = folder / (path + extension);
    if (std::filesystem::is_regular_file(file)) return file;
  }
  return std::nullopt;
}

/// Joints (frames, J, 3) as they are, the first 22 of each frame; nothing for another array.
inline std::optional<std::vector<Vec3<double>>> joints_of_array(const std::filesystem::path& file) {
  if (file.extension() != ".npy") return std::nullopt;
  const NpyArray array = read_npy(FilePath(file));
  const auto& shape = array.shape;
  if (shape.size() != 3 || shape[1] < mtt_joints || shape[2] != 3) return std::nullopt;
  const auto values = array.to<double>();
  std::vector<Vec3<double>> out;
  for (Index f = 0; f < shape[0]; ++f) {
    for (Index j = 0; j < mtt_joints; ++j) {
      const double* p = values.data() + 3 * (f * shape[1] + j);
      out.push_back({p[0], p[1], p[2]});
    }
  }
  const Vec3<double> height = mean_height(out, static_cast<std::size_t>(mtt_joints));
  return std::abs(height.z) > std::abs(height.y) ? turned_up(std::move(out), false) : std::move(out);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<MttClip> parse_mtt_motions(std::string_view file, std::string_view name) {
  std::vector<MttClip> out;
  detail::for_each_line(file, [&](std::string_view content, Index number) {
    if (detail::trim(content).empty()) return;
    const detail::TimelineLine line(content, number, name);
    if (line.fields() != 3) line.fail(501, line.fields(), "expected 'path # start # end'");
    MttClip clip{line.text(), line.seconds(1), line.seconds(2)};
    if (clip.start < 0 || frame_at(clip.end, detail::mtt_fps) <= frame_at(clip.start, detail::mtt_fps))
      line.fail(504, 1, "from ", clip.start, " to ", clip.end, " s there is no frame");
    out.push_back(std::move(clip));
  });
  if (out.empty()) raise<timeline_error>(507, name, ": no line");
  return out;
}

MOTIONLANG_BODY std::vector<Vec3<double>> read_mtt_motion(const FilePath& folder, const MttClip& clip) {
  const std::filesystem::path below = folder.string();
  auto file = detail::mtt_file(below, clip.path);
  const bool mirrored = !file && clip.path.starts_with("M/");
  if (mirrored) file = detail::mtt_file(below, clip.path.substr(2));
  if (!file) raise<io_error>(401, folder.string(), ": there is no motion ", clip.path);
  auto joints = detail::joints_of_array(*file);
  if (!joints) {
    const Motion motion = resample(on_smpl(read_motion(FilePath(*file))), detail::mtt_fps);
    joints = detail::first_joints(motion, static_cast<std::size_t>(detail::mtt_joints));
  }
  const Index frames = std::ssize(*joints) / detail::mtt_joints, first = frame_at(clip.start, detail::mtt_fps),
              end = std::min(frame_at(clip.end, detail::mtt_fps), frames);
  if (end - first < 2)
    raise<shape_error>(203, file->string(), ": ", clip.start, " to ", clip.end, " s is less than two of its ", frames,
                       " frames at 20 per second");
  std::vector<Vec3<double>> out(joints->begin() + first * detail::mtt_joints,
                                joints->begin() + end * detail::mtt_joints);
  if (!mirrored) return out;
  return mirror_joints(std::span<const Vec3<double>>(out),
                       std::span<const int>(humanml3d_mirror_partners(static_cast<int>(detail::mtt_joints))));
}

MOTIONLANG_NAMESPACE_END
