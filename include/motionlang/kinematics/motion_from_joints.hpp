// SPDX-License-Identifier: MIT
/// A clip from the positions of its joints: what models that predict positions need to become BVH, GLB or AMASS.
///
///     const Motion clip = motion_from_joints(humanml3d22_skeleton(), joints, 20);
///
/// Bones get the mean length that they have in the clip, and where several begin at one joint, the angles between them.
/// Each joint is turned so that its bones at rest come nearest to where they are seen, with as little twist against its
/// parent as that leaves open; positions along bones of constant length are met.
/// Source  Mueller, Bender, Chentanez, Macklin: "A robust method to extract the rotational part of deformations" (MIG
///         2016), eq. 7,
///         on pairs of vectors:   omega = sum_i R a_i x b_i / |sum_i R a_i . b_i|,   R <- exp(omega) R
/// World   Y up, as Motion has it
#pragma once

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A vector at rest and where it is seen.
struct SeenVector {
  Vec3<double> rest, seen;
};

/// The rotation that brings vectors at rest nearest to where they are seen, in the sense of least squares, found from
/// `start` on.
Quaternion<double> fit_rotation(std::span<const SeenVector> vectors, Quaternion<double> start);

/// skeleton  its names, parents and the directions of its bones at rest; joints beyond those that are given stay as at
///           rest
/// joints    (frames, count), count <= the joints of the skeleton, of which they are the first
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
