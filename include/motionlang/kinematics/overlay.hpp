// SPDX-License-Identifier: MIT
/// Combines two motions in one body: some parts move as in one clip, the rest as in the other.
#pragma once

#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// `base` with the local rotations of `parts` from `other`, frame by frame, while both last. The path, the height and
/// everything else come from the base. It needs SMPL's joints, or the first of them (HumanML3D). Throws config_error
/// 103 for another skeleton, and 102 for two frame rates.
/// Source  the synthetic training data of SINC (thesis B.2.1), on rotations
Motion overlay_parts(const Motion& base, const Motion& other, BodyParts parts);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/overlay.ipp>
#endif
