// SPDX-License-Identifier: MIT
/// A clip made like another one, so that both can be joined or composed.
#pragma once

#include <motionlang/kinematics/retarget.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The motion on the skeleton and at the rate of another one. If it comes from another skeleton, it stands on the floor
/// of the other motion. Throws what retarget and resample throw.
Motion match_motion(Motion motion, const Motion& other);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/match_motion.ipp>
#endif
