// SPDX-License-Identifier: MIT
/// A clip from the positions of its joints. So models that predict positions can write BVH, GLB or AMASS.
///
///     const Motion clip = motion_from_joints(humanml3d22_skeleton(), joints, 20);
///
/// Bones get their mean length in the clip. If several begin at one joint, the angles between them are also means. Each
/// joint is turned so that its bones at rest come nearest to their observed directions, with as little twist against
/// its parent as possible. Positions along bones of constant length are met exactly.
/// Source  Mueller, Bender, Chentanez, Macklin: "A robust method to extract the rotational part of deformations" (MIG
///         2016), eq. 7, on pairs of vectors:
///             omega = sum_i R a_i x b_i / |sum_i R a_i . b_i|,   R <- exp(omega) R
/// World   Y up, as in Motion
#pragma once

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A vector at rest and its observed direction.
struct SeenVector {
  Vec3<double> rest, seen;
};

/// The rotation that brings vectors at rest nearest to their observed directions, in the sense of least squares. The
/// search begins at `start`.
Quaternion<double> fit_rotation(std::span<const SeenVector> vectors, Quaternion<double> start);

/// skeleton  its names, parents and rest directions of bones; further joints stay at rest
/// joints    (frames, count): the first joints of the skeleton, at most all of them
/// Throws    shape_error 205 unless `joints` are whole frames, config_error 101 for a wrong count or frame rate,
///           numeric_error 301 for a position that is not finite
Motion motion_from_joints(const Skeleton& skeleton, std::span<const Vec3<double>> joints, Index count, double fps);
inline Motion motion_from_joints(const Skeleton& skeleton, std::span<const Vec3<double>> joints, double fps) {
  return motion_from_joints(skeleton, joints, skeleton.size(), fps);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/motion_from_joints.ipp>
#endif
