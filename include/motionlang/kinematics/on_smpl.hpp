// SPDX-License-Identifier: MIT
/// A motion on SMPL's 24 joints, from any skeleton. Models, AMASS files and joint arrays need these joints.
#pragma once

#include <motionlang/kinematics/retarget.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The motion on SMPL's 24 joints. If it has them already, in any order (a BVH file is depth first), they are only put
/// in SMPL's order and the bones keep their lengths. Otherwise it is retargeted.
/// report  is set only if the motion is retargeted
/// Throws  config_error 103 with the missing joint, like retarget
Motion on_smpl(const Motion& motion, RetargetReport* report = nullptr);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/on_smpl.ipp>
#endif
