// SPDX-License-Identifier: MIT
/// Angles in degrees: 30 * degree is in radians, a / degree in degrees.
#pragma once

#include <numbers>  // pi

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

inline constexpr double degree = std::numbers::pi / 180;

MOTIONLANG_NAMESPACE_END
