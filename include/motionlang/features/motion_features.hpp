// SPDX-License-Identifier: MIT
/// The feature vectors of the systems, by name: from a clip to rows of values, and from these to joints and clips.
///
///     const MotionFeatures& f = motion_features("guoh3d");
///     const auto rows = f.from_motion(resample(retarget(clip), f.fps));
///     const Motion back = motion_of_rows(f, rows);
///
///    guoh3d              263   20    HumanML3D's, also TMR's: one row less than frames; positions only
///    kit                 251   12.5  KIT's: 21 joints of MMM, mirrored, 640 units per metre, bones as long as the
///                        clip's; otherwise like guoh3d
///    rifke                67   12.5  TMR's canonical view, 22 joints; positions only
///    rifke64              64   12.5  TEMOS on KIT, 21 joints of MMM as in kit ("LMrot" in the middle of the foot),
///                         positions only
///    smplvelp            135   12.5  TEMOS on SMPL with the exact heading, so that it can be inverted
///    smplvelp-published  135   12.5  TEMOS on SMPL with the published turn, which is not a heading: see
///                        SmplVelpOptions
///    smplrifke           205   20    STMC
///    actor               150   20    ACTOR and MDM's models of actions: 6D rotations and path, in the world of a
///                        camera
/// With positions only, the clip that comes back has rotations that fit them (motion_from_joints.hpp).
/// Source  see guoh3d_extraction.hpp, rifke.hpp, smplvelp.hpp, smplrifke.hpp, pose_representation.hpp; MMM:
///         text-to-motion utils/paramUtil.py, TEMOS temos/transforms
#pragma once

#include <motionlang/features/smplrifke.hpp>
#include <motionlang/features/smplvelp.hpp>
#include <motionlang/kinematics/retarget.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct MotionFeatures {
  std::string_view name;
  Index width = 0;
  double fps = 0;    // of the published systems
  Index joints = 0;  // of `joints_of`: the first joints of `skeleton`
  const Skeleton& (*skeleton)();
  FeatureLayout (*layout)();             // the body part of each value
  std::span<const FeatureRange> ranges;  // the meaning of the values
  /// The rows of a clip on SMPL's 24 joints or on the joints of `skeleton`, at its own frame rate. Throws config_error
  /// 103 for other joints, and shape_error 205 if it is too short.
  std::vector<double> (*from_motion)(const Motion& motion);
  /// (frames, joints), Y up, starting at the origin. Throws shape_error 205.
  std::vector<Vec3<double>> (*joints_of)(std::span<const double> rows);
  /// A clip on the joints of `skeleton`. Null if the rows have no rotations.
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

/// Rotations and root path as ACTOR and MDM have them from videos, as a clip on SMPL's 24 joints, on the floor. In the
/// world of the camera the figure is upside down, so it is turned by 180 degrees about x.
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

/// The first `count` joints of every frame, Y up.
std::vector<Vec3<double>> first_joints(const Motion& motion, std::size_t count);
std::vector<Vec3<double>> turned_up(std::vector<Vec3<double>> points, bool to_z_up);

std::vector<double> guoh3d_rows_of(const Motion& motion);
std::vector<Vec3<double>> joints_of_guoh3d(std::span<const double> rows);

std::vector<double> rifke_rows_of(const Motion& motion);
std::vector<Vec3<double>> joints_of_rifke(std::span<const double> rows);

inline constexpr Index mmm_joints = 21;
inline constexpr double mmm_units_per_metre = 640;

/// The vector from the middle of the ankles to the head, as a mean over the frames, for MMM's or SMPL's joints.
Vec3<double> mean_height(std::span<const Vec3<double>> joints, std::size_t count);
/// The inverse. The joints are in metres or, if the values are large, in KIT's units.
std::vector<Vec3<double>> mmm_in_metres(std::vector<Vec3<double>> joints);

std::vector<double> kit_rows_of(const Motion& motion);
std::vector<Vec3<double>> joints_of_kit(std::span<const double> rows);

std::vector<double> rifke64_rows_of(const Motion& motion);
std::vector<Vec3<double>> joints_of_rifke64(std::span<const double> rows);

std::vector<double> smplvelp_rows(const Motion& motion, bool exact_yaw);
template <bool exact_yaw>
std::vector<double> smplvelp_rows_of(const Motion& motion) {
  return smplvelp_rows(motion, exact_yaw);
}
Motion smplvelp_motion(std::span<const double> rows, double fps);
std::vector<Vec3<double>> joints_of_smplvelp(std::span<const double> rows);

Motion smplrifke_motion(std::span<const double> rows, double fps);
std::vector<Vec3<double>> joints_of_smplrifke(std::span<const double> rows);

}  // namespace detail

/// The inverse: the input of ACTOR's networks for a clip on SMPL's 24 joints. Throws config_error 103 for other joints.
std::vector<double> actor_rows_of_motion(const Motion& motion, const ActorFeatureOptions& options = {});

namespace detail {

std::vector<double> actor_rows_of(const Motion& motion);
Motion actor_motion(std::span<const double> rows, double fps);
std::vector<Vec3<double>> joints_of_actor(std::span<const double> rows);

FeatureLayout layout_of_guoh3d();
FeatureLayout layout_of_kit();
FeatureLayout layout_of_rifke();
FeatureLayout layout_of_rifke64();
FeatureLayout layout_of_smplvelp();
FeatureLayout layout_of_smplrifke();
FeatureLayout layout_of_actor();

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
/// fps     0: that of the published systems
/// Throws  shape_error 205, numeric_error 301 for values that are not finite, config_error 101 for such a rate
Motion motion_of_rows(const MotionFeatures& features, std::span<const double> rows, double fps = 0);

/// Throws config_error 103.
const MotionFeatures& motion_features(std::string_view name);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/features/motion_features.ipp>
#endif
