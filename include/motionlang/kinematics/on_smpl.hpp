// SPDX-License-Identifier: MIT
/// A motion on SMPL's 24 joints, whatever skeleton it is on. Models, AMASS files and joint arrays want it there.
#pragma once

#include <motionlang/kinematics/retarget.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The motion on SMPL's 24 joints. If it has them already, in whatever order (a BVH file goes depth first), they are
/// only put in SMPL's order and the bones keep their lengths. Otherwise it is retargeted.
/// report  is set only if the motion is retargeted
/// Throws  config_error 103 with the joint that is missing, as retarget does
Motion on_smpl(const Motion& motion, RetargetReport* report = nullptr);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/on_smpl.ipp>
#endif
