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

/// All of `base`, with `parts` as in `other` from frame `first` on, as long as both last. In the first and the last
/// `blend` of these frames the parts turn from one motion to the other. The same errors, and config_error 101 for a
/// negative number of frames.
Motion overlay_parts_for_a_while(const Motion& base, const Motion& other, BodyParts parts, Index first, Index blend);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/overlay.ipp>
#endif
