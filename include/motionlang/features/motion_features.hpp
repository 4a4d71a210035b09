// SPDX-License-Identifier: MIT
/// The feature vectors that systems are trained on, by name: from a clip to rows of numbers, and from these to joints
/// and clips.
///
///     const MotionFeatures& f = motion_features("guoh3d");
///     const auto rows = f.from_motion(resample(retarget(clip), f.fps));
///     const Motion back = motion_of_rows(f, rows);
///
///     guoh3d              263   20    HumanML3D's, of TMR   a row less than the clip has frames; positions alone
///     kit                 251   12.5  KIT's, 21 joints of MMM, reflected, 640 units per metre, bones as long as the
///                         clip's; else as guoh3d
///     rifke                67   12.5  TMR's canonical view, 22 joints; positions alone
///     rifke64              64   12.5  TEMOS on KIT, 21 joints of MMM as in kit ("LMrot" in the middle of the foot);
///                          positions alone
///     smplvelp            135   12.5  TEMOS on SMPL         with the exact heading, so that it is there and back
///     smplvelp-published  135   12.5  TEMOS on SMPL         with the turn of its repository, which is no heading: see
///                         SmplVelpOptions
///     smplrifke           205   20    STMC
///     actor               150   20    ACTOR and MDM's models of actions: 6D rotations and way, in the world of a
///                         camera
/// Positions alone: the clip that comes back has rotations that fit them (motion_from_joints.hpp).
/// Source  see guoh3d_extraction.hpp, rifke.hpp, smplvelp.hpp, smplrifke.hpp, pose_representation.hpp; MMM: specs
///         humanml3d-features.md 1.2 and 10, temos.md 4.1 and 4.3
#pragma once

#include <algorithm>  // find_if
#include <cmath>      // isfinite

#include <motionlang/features/guoh3d.hpp>
#include <motionlang/features/guoh3d_extraction.hpp>
#include <motionlang/features/rifke.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/features/smplvelp.hpp>
#include <motionlang/kinematics/motion_from_joints.hpp>
#include <motionlang/kinematics/retarget.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct MotionFeatures {
  std::string_view name;
  Index width = 0;
  double fps = 0;    // that the published systems use
  Index joints = 0;  // of `joints_of`: the first ones of `skeleton`
  const Skeleton& (*skeleton)();
  FeatureLayout (*layout)();             // which numbers belong to which body part
  std::span<const FeatureRange> ranges;  // what the numbers mean
  /// The rows of a clip on SMPL's 24 joints, or on the joints of `skeleton`, that has the rate already. Throws
  /// config_error 103 if the joints are others, shape_error 205 if it is too short.
  std::vector<double> (*from_motion)(const Motion& motion);
  /// (frames, joints), Y up, from the origin on. Throws shape_error 205.
  std::vector<Vec3<double>> (*joints_of)(std::span<const double> rows);
  /// A clip on the joints of `skeleton`; null where the rows have no rotations.
  Motion (*to_motion)(std::span<const double> rows, double fps);
};

/// Rotations of 22 joints and translation, Z up, as a clip on SMPL's 24 joints.
template <Scalar S>
Motion motion_of_smplvelp(const SmplVelpMotion<S>& from, double fps) {
  const auto y_up = axis_rotation(0, -std::numbers::pi / 2);
  Motion out{smpl24_skeleton(), fps, {}, {}, {}};
  for (const Vec3<S>& p : from.trans)
    out.root.push_back({static_cast<double>(p.x), static_cast<double>(p.z), -static_cast<double>(p.y)});
  for (std::size_t i = 0; i < from.rotations.size(); ++i) {
    const auto r = matrix_cast<double>(from.rotations[i]);
    out.local.push_back(to_quaternion(i % 22 == 0 ? y_up * r : r));
    if (i % 22 == 21) out.local.insert(out.local.end(), 2, Quaternion<double>::identity());  // hands
  }
  return out;
}

/// Rotations and the way of the root as ACTOR and MDM have them of videos, as a clip on SMPL's 24 joints, on the floor.
/// In the world of the camera the figure stands on its head: it is turned by 180 degrees about x.
template <Scalar S>
Motion motion_of_actor(const ActorMotion<S>& from, double fps) {
  const auto upright = axis_rotation(0, std::numbers::pi);
  Motion out{smpl24_skeleton(), fps, {}, {}, {}};
  for (const Vec3<S>& p : from.root) out.root.push_back(upright * vec_cast<double>(p));
  for (std::size_t i = 0; i < from.rotations.size(); ++i) {
    const auto r = matrix_cast<double>(from.rotations[i]);
    out.local.push_back(to_quaternion(i % 24 == 0 ? upright * r : r));
  }
  place_on_floor(out);
  return out;
}

namespace detail {

inline void require_smpl24(const Motion& motion) {
  if (motion.skeleton.names != smpl24_skeleton().names || motion.skeleton.parents != smpl24_skeleton().parents) {
    raise<config_error>(103, "motion_features: the ", motion.skeleton.size(), " joints of '", motion.name,
                        "' are not the 24 of SMPL; retarget first");
  }
}
/// The first `count` joints of every frame, Y up.
inline std::vector<Vec3<double>> first_joints(const Motion& motion, std::size_t count) {
  require_smpl24(motion);
  const auto all = motion.positions();
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  std::vector<Vec3<double>> out;
  for (std::size_t at = 0; at < all.size(); at += joints)
    out.insert(out.end(), all.begin() + static_cast<std::ptrdiff_t>(at),
               all.begin() + static_cast<std::ptrdiff_t>(at + count));
  return out;
}
inline std::vector<Vec3<double>> turned_up(std::vector<Vec3<double>> points, bool to_z_up) {
  for (Vec3<double>& p : points) p = to_z_up ? Vec3<double>{p.x, -p.z, p.y} : Vec3<double>{p.x, p.z, -p.y};
  return points;
}

inline std::vector<double> guoh3d_rows_of(const Motion& motion) {
  const auto joints = first_joints(motion, 22);
  return guoh3d_features(humanml3d_chains(), std::span<const Vec3<double>>(joints));
}
inline std::vector<Vec3<double>> joints_of_guoh3d(std::span<const double> rows) { return guoh3d_joints(rows); }

inline std::vector<double> rifke_rows_of(const Motion& motion) {
  const auto joints = turned_up(first_joints(motion, 22), true);
  return rifke_features(tmr_rifke(22), std::span<const Vec3<double>>(joints)).features;
}
inline std::vector<Vec3<double>> joints_of_rifke(std::span<const double> rows) {
  return turned_up(rifke_joints(tmr_rifke(22), rows), false);
}

inline constexpr Index mmm_joints = 21;
inline constexpr double mmm_units_per_metre = 640;

/// MMM's joints of every frame as KIT has them and TEMOS makes them: reflected, Y up.
inline std::vector<Vec3<double>> mmm_joints_of(const Motion& motion) {
  const bool own =
      motion.skeleton.names == kit21_skeleton().names && motion.skeleton.parents == kit21_skeleton().parents;
  if (!own) require_smpl24(motion);
  auto joints = (own ? motion : retarget(motion, kit21_skeleton())).positions();
  for (Vec3<double>& p : joints) p = mmm_units_per_metre * Vec3<double>{-p.x, p.y, p.z};
  return joints;
}
/// The vector from between the ankles to the head, mean over the frames; of MMM's or of SMPL's joints.
inline Vec3<double> mean_height(std::span<const Vec3<double>> joints, std::size_t count) {
  const bool mmm = count == mmm_joints;
  const std::size_t head = mmm ? 4 : 15, left = mmm ? 13 : 7, right = mmm ? 18 : 8;
  Vec3<double> sum{};
  for (std::size_t at = 0; at < joints.size(); at += count) {
    sum = sum + joints[at + head] - 0.5 * (joints[at + left] + joints[at + right]);
  }
  return joints.empty() ? sum : (static_cast<double>(count) / static_cast<double>(joints.size())) * sum;
}
/// The way back. The joints are in metres or, if they are large, in KIT's units.
inline std::vector<Vec3<double>> mmm_in_metres(std::vector<Vec3<double>> joints) {
  const double unit = norm(mean_height(joints, mmm_joints)) > 20 ? 1 / mmm_units_per_metre : 1;
  for (Vec3<double>& p : joints) p = unit * Vec3<double>{-p.x, p.y, p.z};
  return joints;
}

inline std::vector<double> kit_rows_of(const Motion& motion) {
  const auto joints = mmm_joints_of(motion);
  const std::span<const Vec3<double>> all(joints);
  const auto lengths =
      joints.empty() ? std::vector<double>(mmm_joints) : bone_lengths(kit_chains(), all.first(mmm_joints));
  return guoh3d_features(kit_chains(), all, std::span<const double>(lengths));
}
inline std::vector<Vec3<double>> joints_of_kit(std::span<const double> rows) {
  return mmm_in_metres(guoh3d_joints(rows, mmm_joints));
}

inline std::vector<double> rifke64_rows_of(const Motion& motion) {
  const auto joints = mmm_joints_of(motion);
  return rifke_features(temos_rifke(), std::span<const Vec3<double>>(joints)).features;
}
inline std::vector<Vec3<double>> joints_of_rifke64(std::span<const double> rows) {
  return mmm_in_metres(rifke_joints(temos_rifke(), rows));
}

template <bool exact_yaw>
std::vector<double> smplvelp_rows_of(const Motion& motion) {
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
inline Motion smplvelp_motion(std::span<const double> rows, double fps) {
  return motion_of_smplvelp(smplvelp_inverse(rows), fps);
}
inline std::vector<Vec3<double>> joints_of_smplvelp(std::span<const double> rows) {
  return first_joints(smplvelp_motion(rows, 12.5), 22);
}

inline Motion smplrifke_motion(std::span<const double> rows, double fps) { return smplrifke_to_motion(rows, {}, fps); }
inline std::vector<Vec3<double>> joints_of_smplrifke(std::span<const double> rows) {
  return first_joints(smplrifke_motion(rows, 20), 22);
}

}  // namespace detail

/// The way back: what ACTOR's networks read of a clip on SMPL's 24 joints. Throws config_error 103 for other joints.
inline std::vector<double> actor_rows_of_motion(const Motion& motion, const ActorFeatureOptions& options = {}) {
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

inline std::vector<double> actor_rows_of(const Motion& motion) { return actor_rows_of_motion(motion); }
inline Motion actor_motion(std::span<const double> rows, double fps) {
  return motion_of_actor(actor_inverse(rows), fps);
}
inline std::vector<Vec3<double>> joints_of_actor(std::span<const double> rows) {
  return first_joints(actor_motion(rows, 20), 22);
}

inline FeatureLayout layout_of_guoh3d() { return guoh3dfeats_layout(); }
inline FeatureLayout layout_of_kit() { return guoh3dfeats_layout(kit_part_of_joint); }
inline FeatureLayout layout_of_rifke() { return rifke_layout(); }
inline FeatureLayout layout_of_rifke64() { return rifke_layout(kit_part_of_joint); }
inline FeatureLayout layout_of_smplvelp() { return smplvelp_layout(); }
inline FeatureLayout layout_of_smplrifke() { return smplrifke_layout(); }
inline FeatureLayout layout_of_actor() { return actor_layout(); }

}  // namespace detail

inline constexpr std::array<MotionFeatures, 8> all_motion_features{{
    {"guoh3d", 263, 20, 22, &smpl24_skeleton, &detail::layout_of_guoh3d, guoh3dfeats_ranges, &detail::guoh3d_rows_of,
     &detail::joints_of_guoh3d, nullptr},
    {"kit", 251, 12.5, 21, &kit21_skeleton, &detail::layout_of_kit, kit_ranges, &detail::kit_rows_of,
     &detail::joints_of_kit, nullptr},
    {"rifke", 67, 12.5, 22, &smpl24_skeleton, &detail::layout_of_rifke, rifke_ranges, &detail::rifke_rows_of,
     &detail::joints_of_rifke, nullptr},
    {"rifke64", 64, 12.5, 21, &kit21_skeleton, &detail::layout_of_rifke64, rifke64_ranges, &detail::rifke64_rows_of,
     &detail::joints_of_rifke64, nullptr},
    {"smplvelp", 135, 12.5, 22, &smpl24_skeleton, &detail::layout_of_smplvelp, smplvelp_ranges,
     &detail::smplvelp_rows_of<true>, &detail::joints_of_smplvelp, &detail::smplvelp_motion},
    {"smplvelp-published", 135, 12.5, 22, &smpl24_skeleton, &detail::layout_of_smplvelp, smplvelp_ranges,
     &detail::smplvelp_rows_of<false>, &detail::joints_of_smplvelp, &detail::smplvelp_motion},
    {"smplrifke", smplrifke_size, 20, 22, &smpl24_skeleton, &detail::layout_of_smplrifke, smplrifke_ranges,
     &smplrifke_from_motion, &detail::joints_of_smplrifke, &detail::smplrifke_motion},
    {"actor", 150, 20, 22, &smpl24_skeleton, &detail::layout_of_actor, actor_ranges, &detail::actor_rows_of,
     &detail::joints_of_actor, &detail::actor_motion},
}};

/// The clip of rows, on the joints of the features.
/// fps     0: as the published systems have it
/// Throws  shape_error 205, numeric_error 301 for values that are not finite, config_error 101 for such a rate
inline Motion motion_of_rows(const MotionFeatures& features, std::span<const double> rows, double fps = 0) {
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

/// Throws config_error 103.
inline const MotionFeatures& motion_features(std::string_view name) {
  for (const MotionFeatures& f : all_motion_features) {
    if (f.name == name) return f;
  }
  raise<config_error>(103, "motion_features: '", name, "' is not one of ",
                      join_text(all_motion_features, ", ", [](const MotionFeatures& f) { return f.name; }));
}

MOTIONLANG_NAMESPACE_END
