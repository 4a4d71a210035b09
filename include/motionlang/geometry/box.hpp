// SPDX-License-Identifier: MIT
/// The box around positions.
#pragma once

#include <algorithm>  // min, max
#include <span>       // positions

#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A box with sides along the axes.
struct Box {
  Vec3<double> low, high;
};

/// The box around all positions. Throws config_error 101 without a position.
inline Box box_of(std::span<const Vec3<double>> positions) {
  if (positions.empty()) raise<config_error>(101, "box_of: no position");
  Box box{positions.front(), positions.front()};
  for (const auto& p : positions) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

MOTIONLANG_NAMESPACE_END
