// SPDX-License-Identifier: MIT
/// The skeletons of the field: names, order and parents as published. The bone lengths are those of a neutral figure of
/// our own (1.75 m), so that no licensed body model is needed. Rest pose: standing, arms to the sides, Y up, facing +Z,
/// left at +X, metres.
#pragma once

#include <motionlang/kinematics/skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// SMPL, 24 joints. Source: Loper et al. 2015; names as in the smplx package.
const Skeleton& smpl24_skeleton();

/// HumanML3D, 22 joints: SMPL without the hands.
const Skeleton& humanml3d22_skeleton();

/// KIT Motion-Language, 21 joints of the Master Motor Map, in metres here. The coordinates of the data set have other
/// units.
const Skeleton& kit21_skeleton();

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/known_skeletons.ipp>
#endif
