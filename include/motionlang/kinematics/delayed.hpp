// SPDX-License-Identifier: MIT
/// A motion that begins later: its first frame stands until then.
///
///     const Motion kept = delayed(crop(dance, 40, 90), 2.5);  // to be kept at 2.5 s of a timeline (generate/)
#pragma once

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The number of frames in front is that of the seconds, rounded. Throws config_error 101 for seconds below 0 and for
/// too many frames, shape_error 203 without a frame.
Motion delayed(const Motion& motion, double seconds);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/delayed.ipp>
#endif
