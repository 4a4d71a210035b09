// SPDX-License-Identifier: MIT
// Bodies of describe_motion.hpp.
#pragma once

#include <algorithm>  // is_permutation
#include <span>       // positions

#include <motionlang/core/formatted.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/datasets/data_set_form.hpp>
#include <motionlang/file/npz.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/amass_sequence.hpp>
#include <motionlang/formats/mdm_results.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/geometry/box.hpp>
#include <motionlang/kinematics/describe_skeleton.hpp>
#include <motionlang/kinematics/on_smpl.hpp>
#include <motionlang/metrics/motion_quality.hpp>
#include <motionlang/view/describe_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The smallest box around the positions. Needs at least one position.
inline std::string extent_text(std::span<const Vec3<double>> positions) {
  const auto [low, high] = box_of(positions);
  return formatted("x %.2f ... %.2f, y %.2f ... %.2f, z %.2f ... %.2f m", low.x, high.x, low.y, high.y, low.z, high.z);
}

inline bool holds_positions(const FilePath& path) {
  if (file_kind(path) != ".npy") return false;
  const auto shape = npy_shape(path.string());
  return shape.size() == 3 && shape.back() == 3;
}

inline std::string describe_positions(const FilePath& path) {
  const auto read = read_joints_npy(path);
  std::string out = concat_text(path.string(), ": joint positions, ", counted(read.frames, "frame"), " of ",
                                counted(read.joints, "joint"), "\n");
  if (!read.positions.empty())
    out += "  read as Z up and turned to Y up, joints are within " + extent_text(read.positions) + "\n";
  return out;
}

}  // namespace detail

MOTIONLANG_BODY bool holds_motions(const FilePath& path) {
  const std::string kind = file_kind(path);
  if (kind == ".npy") return detail::holds_positions(path) || may_be_mdm_motions(path);
  if (kind == ".npz") return !amass_poses(NpzArchive::open(path)).empty();
  return kind == ".bvh" || kind == ".amc" || is_gltf(path);
}

MOTIONLANG_BODY std::string describe_motion(const std::string& name, const Motion& m) {
  std::string out =
      printable(name) + formatted(": %s, %g frames per second, %.2f s, %s\n", counted(m.frames(), "frame").c_str(),
                                  m.fps, m.seconds(), counted(m.skeleton.size(), "joint").c_str());
  if (m.frames() == 0) return out;
  out += "  root moves within " + detail::extent_text(m.root) + "\n";
  if (const auto& smpl = smpl24_skeleton().names; std::is_permutation(
          m.skeleton.names.begin(), m.skeleton.names.end(), smpl.begin(), smpl.end())) {  // BVH has them depth first
    const auto q = motion_quality(on_smpl(m));
    out += formatted("  feet on the floor %.0f %% of the time, sliding at %.2f m/s; jitter %.0f m/s^3; ",
                     100 * q.feet.contact, q.feet.speed, q.jitter);
    out += formatted("%.1f cm below the floor\n", 100 * q.below_floor.mean);
  }
  return out + describe_skeleton(m.skeleton);
}

MOTIONLANG_BODY std::string describe_motion_file(const FilePath& path) {
  if (detail::holds_positions(path)) return detail::describe_positions(path);
  std::string notes;
  const auto motions = read_motions(path, {}, &notes);
  std::string out = printable(notes, "\n");
  if (motions.size() == 1) return out + describe_motion(path.string(), motions.front());
  out += concat_text(motions.size(), is_gltf(path)               ? " animations\n"
                                     : file_kind(path) == ".bvh" ? " roots\n"
                                                                 : " motions\n");
  for (std::size_t i = 0; i < motions.size(); ++i)
    out += formatted("  %zu %s, %.2f s\n", i, printable(motions[i].name).c_str(), motions[i].seconds());
  return out + describe_motion(path.string() + ", 0 " + motions.front().name, motions.front());
}

MOTIONLANG_NAMESPACE_END
