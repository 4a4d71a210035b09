// SPDX-License-Identifier: MIT
/// The body parts that a recording moves, measured instead of read from its text: SINC's baseline.
///
/// Source  thesis B.2.1, "Could we extract body part labels without GPT-3?"; SINC sinc/data/babel.py compute_heuristic
/// Differs from the paper, which standardises: the six speeds are scaled to 0 ... 1, as in the code
#pragma once

#include <algorithm>  // minmax_element
#include <span>       // joints

#include <motionlang/core/error.hpp>
#include <motionlang/geometry/vec.hpp>
#include <motionlang/kinematics/sinc_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Mean over time of the length of the mean step of a part's joints.
/// joints  (frames, 22), two frames or more. Throws shape_error 205.
template <Scalar S>
std::array<S, sinc_part_count> sinc_part_speeds(std::span<const Vec3<S>> joints) {
  constexpr std::size_t n = sinc_part_of_joint.size();
  const std::size_t frames = joints.size() / n;
  if (frames < 2 || joints.size() != frames * n) {
    raise<shape_error>(205, "sinc_part_speeds: ", joints.size(), " joints; expected 22 for each of two frames or more");
  }
  std::array<S, sinc_part_count> speeds{};
  for (std::size_t f = 1; f < frames; ++f) {
    std::array<Vec3<S>, sinc_part_count> step{};
    std::array<S, sinc_part_count> count{};
    for (std::size_t j = 0; j < n; ++j) {
      const auto part = static_cast<std::size_t>(sinc_part_of_joint[j]);
      step[part] = step[part] + (joints[f * n + j] - joints[(f - 1) * n + j]);
      count[part] += S(1);
    }
    for (std::size_t p = 0; p < sinc_part_count; ++p)
      speeds[p] += norm(step[p]) / count[p] / static_cast<S>(frames - 1);
  }
  return speeds;
}

/// The parts that are faster than `threshold` of the range from the slowest to the fastest. None if nothing moves.
template <Scalar S>
SincParts moving_sinc_parts(const std::array<S, sinc_part_count>& speeds, double threshold = 0.65) {
  const auto [least, most] = std::minmax_element(speeds.begin(), speeds.end());
  SincParts out;
  for (std::size_t p = 0; p < sinc_part_count; ++p) {
    out[p] = static_cast<double>((speeds[p] - *least) / (*most - *least)) > threshold;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
