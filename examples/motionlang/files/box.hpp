// The box around positions.
#pragma once

#include <algorithm>
#include <span>

#include <motionlang/geometry/vec.hpp>

namespace program {

struct Box {
  motionlang::Vec3<double> low, high;
};

/// Of one position at least.
inline Box box_of(std::span<const motionlang::Vec3<double>> positions) {
  Box box{positions.front(), positions.front()};
  for (const auto& p : positions) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

}  // namespace program
