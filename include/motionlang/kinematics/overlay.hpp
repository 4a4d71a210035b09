// SPDX-License-Identifier: MIT
/// Two motions in one body: some parts move as in one clip, the rest as in another.
#pragma once

#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// `base` with the local rotations of `parts` taken from `other`, frame by frame, as long as both last. The path, the
/// height and everything else are the base's. SMPL's joints only, or the first of them (HumanML3D). Throws config_error
/// 103 for another skeleton, 102 for two frame rates.
/// Source  the synthetic training data of SINC (thesis B.2.1), on rotations
Motion overlay_parts(const Motion& base, const Motion& other, BodyParts parts);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/overlay.ipp>
#endif
