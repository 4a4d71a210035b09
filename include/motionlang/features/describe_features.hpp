// SPDX-License-Identifier: MIT
/// The meaning of the values of a feature vector as text: what each value is, its unit, and its body part.
#pragma once

#include <string>  // lines

#include <motionlang/features/motion_features.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// "guoh3d: 263 numbers in a frame, 20 frames per second, skeleton of 24 joints", and the end of the line.
std::string line_about_features(const MotionFeatures& features);
/// The same, then the values in order, those of each body part, and the joints.
std::string describe_features(const MotionFeatures& features);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/features/describe_features.ipp>
#endif
