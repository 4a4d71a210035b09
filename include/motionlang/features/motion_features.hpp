// SPDX-License-Identifier: MIT
/// The feature vectors that systems are trained on, by name: from a clip to rows of numbers, and from these to joints and
/// clips.
///
///     const MotionFeatures& f = motion_features("guoh3d");
///     const auto rows = f.from_motion(resample(retarget(clip), f.fps));
///
///     guoh3d      263   20    HumanML3D's, of TMR           a row less than the clip has frames; no rotations to go back from
///     rifke        67   12.5  TMR's canonical view, 22 joints, of TEMOS where SMPL-H's heels are not to be had; positions alone
///     smplvelp    135   12.5  TEMOS on SMPL                 with the exact heading, so that it is there and back
///     smplrifke   205   20    STMC
/// Source  see guoh3d_extraction.hpp, rifke.hpp, smplvelp.hpp, smplrifke.hpp
#pragma once

#include <motionlang/features/guoh3d.hpp>
#include <motionlang/features/guoh3d_extraction.hpp>
#include <motionlang/features/rifke.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/features/smplvelp.hpp>
#include <motionlang/kinematics/retarget.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

struct MotionFeatures {
  std::string_view name;
  Index width = 0;
  double fps = 0;    // that the published systems use
  Index joints = 0;  // of `joints_of`: the first ones of SMPL
  /// The rows of a clip on SMPL's 24 joints that has the rate already. Throws config_error 103 if the joints are others,
  /// shape_error 205 if it is too short.
  std::vector<double> (*from_motion)(const Motion& motion);
  /// (frames, joints), Y up, from the origin on. Throws shape_error 205.
  std::vector<Vec3<double>> (*joints_of)(std::span<const double> rows);
  /// A clip on SMPL's 24 joints; null where the rows have no rotations.
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

/// Rotations and the way of the root as ACTOR and MDM have them of videos, as a clip on SMPL's 24 joints, on the floor. In the world of
/// the camera the figure stands on its head: it is turned by 180 degrees about x.
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

inline std::vector<double> smplvelp_rows_of(const Motion& motion) {
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
                           std::span<const Vec3<double>>(turned_up(motion.root, true)), {.exact_yaw = true});
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

inline constexpr std::array<MotionFeatures, 4> all_motion_features{{
    {"guoh3d", 263, 20, 22, &detail::guoh3d_rows_of, &detail::joints_of_guoh3d, nullptr},
    {"rifke", 67, 12.5, 22, &detail::rifke_rows_of, &detail::joints_of_rifke, nullptr},
    {"smplvelp", 135, 12.5, 22, &detail::smplvelp_rows_of, &detail::joints_of_smplvelp, &detail::smplvelp_motion},
    {"smplrifke", smplrifke_size, 20, 22, &smplrifke_from_motion, &detail::joints_of_smplrifke,
     &detail::smplrifke_motion},
}};

/// Throws config_error 103.
inline const MotionFeatures& motion_features(std::string_view name) {
  std::string known;
  for (const MotionFeatures& f : all_motion_features) {
    if (f.name == name) return f;
    known += concat_text(known.empty() ? "" : ", ", f.name);
  }
  raise<config_error>(103, "motion_features: '", name, "' is none of ", known);
}

}  // namespace motionlang::inline MOTIONLANG_ABI
