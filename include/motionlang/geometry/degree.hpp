// SPDX-License-Identifier: MIT
/// Angles in degrees: 30 * degree is in radians, a / degree in degrees.
#pragma once

#include <numbers>  // pi

#include <motionlang/version.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

inline constexpr double degree = std::numbers::pi / 180;

}  // namespace motionlang::inline MOTIONLANG_ABI
