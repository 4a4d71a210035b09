// SPDX-License-Identifier: MIT
/// The side that a motion prefers. Y up, metres.
///
///     if (leading_side(wave, BodyParts{}.with(BodyPart::right_arm)) == Side::left) wave = mirror(wave);
#pragma once

#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/joint_sides.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The first of these that holds; Side::middle if none does:
///   - the side to which the figure turns by more than 60 degrees in all
///   - the arm whose wrist goes half as far again as the other, and at least 0.3 m further, if an arm is among `parts`
///   - the arm whose wrist is 0.25 m higher than the other in the mean, likewise
///   - the leg whose ankle rises 0.2 m higher above its lowest place, if legs are among `parts`
/// The limits are ours, chosen on the clips of the bundled model. Throws config_error 103 for a skeleton that does not
/// begin with SMPL's 22 joints.
Side leading_side(const Motion& motion, BodyParts parts);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/leading_side.ipp>
#endif
