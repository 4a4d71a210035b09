// SPDX-License-Identifier: MIT
/// Adapts a clip to another one, so that both can be joined or composed.
#pragma once

#include <motionlang/kinematics/retarget.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The motion on the skeleton and at the rate of another one. If it was on another skeleton, it is put on the floor of
/// the other motion. Throws what retarget and resample throw.
Motion match_motion(Motion motion, const Motion& other);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/match_motion.ipp>
#endif
