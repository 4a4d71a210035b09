// SPDX-License-Identifier: MIT
// Bodies of motion_features.hpp.
#pragma once

#include <algorithm>  // find_if
#include <cmath>      // isfinite

#include <motionlang/features/guoh3d.hpp>
#include <motionlang/features/guoh3d_extraction.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/rifke.hpp>
#include <motionlang/kinematics/motion_from_joints.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline void require_smpl24(const Motion& motion) {
  if (motion.skeleton.names != smpl24_skeleton().names || motion.skeleton.parents != smpl24_skeleton().parents) {
    raise<config_error>(103, "motion_features: the ", motion.skeleton.size(), " joints of '", motion.name,
                        "' are not the 24 of SMPL; retarget first");
  }
}

MOTIONLANG_BODY std::vector<Vec3<double>> first_joints(const Motion& motion, std::size_t count) {
  require_smpl24(motion);
  const auto all = motion.positions();
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  std::vector<Vec3<double>> out;
  for (std::size_t at = 0; at < all.size(); at += joints)
    out.insert(out.end(), all.begin() + static_cast<std::ptrdiff_t>(at),
               all.begin() + static_cast<std::ptrdiff_t>(at + count));
  return out;
}

MOTIONLANG_BODY std::vector<Vec3<double>> turned_up(std::vector<Vec3<double>> points, bool to_z_up) {
  for (Vec3<double>& p : points) p = to_z_up ? Vec3<double>{p.x, -p.z, p.y} : Vec3<double>{p.x, p.z, -p.y};
  return points;
}

MOTIONLANG_BODY std::vector<double> guoh3d_rows_of(const Motion& motion) {
  const auto joints = first_joints(motion, 22);
  return guoh3d_features(humanml3d_chains(), std::span<const Vec3<double>>(joints));
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_guoh3d(std::span<const double> rows) { return guoh3d_joints(rows); }

MOTIONLANG_BODY std::vector<double> rifke_rows_of(const Motion& motion) {
  const auto joints = turned_up(first_joints(motion, 22), true);
  return rifke_features(tmr_rifke(22), std::span<const Vec3<double>>(joints)).features;
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_rifke(std::span<const double> rows) {
  return turned_up(rifke_joints(tmr_rifke(22), rows), false);
}

/// MMM's joints of every frame in the form of KIT and TEMOS: reflected, Y up.
inline std::vector<Vec3<double>> mmm_joints_of(const Motion& motion) {
  const bool own =
      motion.skeleton.names == kit21_skeleton().names && motion.skeleton.parents == kit21_skeleton().parents;
  if (!own) require_smpl24(motion);
  auto joints = (own ? motion : retarget(motion, kit21_skeleton())).positions();
  for (Vec3<double>& p : joints) p = mmm_units_per_metre * Vec3<double>{-p.x, p.y, p.z};
  return joints;
}

MOTIONLANG_BODY Vec3<double> mean_height(std::span<const Vec3<double>> joints, std::size_t count) {
  const bool mmm = count == mmm_joints;
  const std::size_t head = mmm ? 4 : 15, left = mmm ? 13 : 7, right = mmm ? 18 : 8;
  Vec3<double> sum{};
  for (std::size_t at = 0; at < joints.size(); at += count) {
    sum = sum + joints[at + head] - 0.5 * (joints[at + left] + joints[at + right]);
  }
  return joints.empty() ? sum : (static_cast<double>(count) / static_cast<double>(joints.size())) * sum;
}

MOTIONLANG_BODY std::vector<Vec3<double>> mmm_in_metres(std::vector<Vec3<double>> joints) {
  const double unit = norm(mean_height(joints, mmm_joints)) > 20 ? 1 / mmm_units_per_metre : 1;
  for (Vec3<double>& p : joints) p = unit * Vec3<double>{-p.x, p.y, p.z};
  return joints;
}

MOTIONLANG_BODY std::vector<double> kit_rows_of(const Motion& motion) {
  const auto joints = mmm_joints_of(motion);
  const std::span<const Vec3<double>> all(joints);
  const auto lengths =
      joints.empty() ? std::vector<double>(mmm_joints) : bone_lengths(kit_chains(), all.first(mmm_joints));
  return guoh3d_features(kit_chains(), all, std::span<const double>(lengths));
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_kit(std::span<const double> rows) {
  return mmm_in_metres(guoh3d_joints(rows, mmm_joints));
}

MOTIONLANG_BODY std::vector<double> rifke64_rows_of(const Motion& motion) {
  const auto joints = mmm_joints_of(motion);
  return rifke_features(temos_rifke(), std::span<const Vec3<double>>(joints)).features;
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_rifke64(std::span<const double> rows) {
  return mmm_in_metres(rifke_joints(temos_rifke(), rows));
}

MOTIONLANG_BODY std::vector<double> smplvelp_rows(const Motion& motion, bool exact_yaw) {
  require_smpl24(motion);
  const auto z_up = axis_rotation(0, std::numbers::pi / 2);
  std::vector<Matrix3<double>> rotations;
  for (Index f = 0; f < motion.frames(); ++f) {
    for (std::size_t j = 0; j < 22; ++j) {
      const auto r = to_matrix(motion.rotations(f)[j]);
      rotations.push_back(j == 0 ? z_up * r : r);
    }
  }
  return smplvelp_features(std::span<const Matrix3<double>>(rotations),
                           std::span<const Vec3<double>>(turned_up(motion.root, true)), {.exact_yaw = exact_yaw});
}

MOTIONLANG_BODY Motion smplvelp_motion(std::span<const double> rows, double fps) {
  return motion_of_smplvelp(smplvelp_inverse(rows), fps);
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_smplvelp(std::span<const double> rows) {
  return first_joints(smplvelp_motion(rows, 12.5), 22);
}

MOTIONLANG_BODY Motion smplrifke_motion(std::span<const double> rows, double fps) {
  return smplrifke_to_motion(rows, {}, fps);
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_smplrifke(std::span<const double> rows) {
  return first_joints(smplrifke_motion(rows, 20), 22);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<double> actor_rows_of_motion(const Motion& motion, const ActorFeatureOptions& options) {
  detail::require_smpl24(motion);
  const auto upside_down = axis_rotation(0, std::numbers::pi);
  std::vector<Matrix3<double>> rotations;
  for (std::size_t i = 0; i < motion.local.size(); ++i) {
    const auto r = to_matrix(motion.local[i]);
    rotations.push_back(i % 24 == 0 ? upside_down * r : r);
  }
  std::vector<Vec3<double>> root;
  for (const Vec3<double>& p : motion.root) root.push_back(upside_down * p);
  return actor_frame_features(std::span<const Matrix3<double>>(rotations), std::span<const Vec3<double>>(root), 24,
                              options);
}

namespace detail {

MOTIONLANG_BODY std::vector<double> actor_rows_of(const Motion& motion) { return actor_rows_of_motion(motion); }

MOTIONLANG_BODY Motion actor_motion(std::span<const double> rows, double fps) {
  return motion_of_actor(actor_inverse(rows), fps);
}

MOTIONLANG_BODY std::vector<Vec3<double>> joints_of_actor(std::span<const double> rows) {
  return first_joints(actor_motion(rows, 20), 22);
}

MOTIONLANG_BODY FeatureLayout layout_of_guoh3d() { return guoh3dfeats_layout(); }

MOTIONLANG_BODY FeatureLayout layout_of_kit() { return guoh3dfeats_layout(kit_part_of_joint); }

MOTIONLANG_BODY FeatureLayout layout_of_rifke() { return rifke_layout(); }

MOTIONLANG_BODY FeatureLayout layout_of_rifke64() { return rifke_layout(kit_part_of_joint); }

MOTIONLANG_BODY FeatureLayout layout_of_smplvelp() { return smplvelp_layout(); }

MOTIONLANG_BODY FeatureLayout layout_of_smplrifke() { return smplrifke_layout(); }

MOTIONLANG_BODY FeatureLayout layout_of_actor() { return actor_layout(); }

}  // namespace detail

MOTIONLANG_BODY Motion motion_of_rows(const MotionFeatures& features, std::span<const double> rows, double fps) {
  const double rate = fps > 0 ? fps : features.fps;
  const auto odd = std::find_if(rows.begin(), rows.end(), [](double x) { return !std::isfinite(x); });
  if (odd != rows.end()) {
    const Index at = odd - rows.begin();
    raise<numeric_error>(301, "motion_of_rows: number ", at % features.width, " of frame ", at / features.width,
                         " is not finite");
  }
  if (features.to_motion != nullptr) {
    Motion out = features.to_motion(rows, rate);
    out.validate();
    return out;
  }
  return motion_from_joints(features.skeleton(), features.joints_of(rows), features.joints, rate);
}

MOTIONLANG_BODY const MotionFeatures& motion_features(std::string_view name) {
  for (const MotionFeatures& f : all_motion_features) {
    if (f.name == name) return f;
  }
  raise<config_error>(103, "motion_features: '", name, "' is not one of ",
                      join_text(all_motion_features, ", ", [](const MotionFeatures& f) { return f.name; }));
}

MOTIONLANG_NAMESPACE_END
