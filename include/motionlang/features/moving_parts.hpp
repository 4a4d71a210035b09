// SPDX-License-Identifier: MIT
/// Which body parts of a recorded motion are in action, told from the positions of its joints: SINC's baseline for the
/// answers of a language model (compose/body_part_answers.hpp).
///
/// Source  SINC (Athanasiou et al., ICCV 2023), section 4.4; sinc/data/babel.py compute_heuristic; spec sinc.md 6.5
#pragma once

#include <algorithm>  // minmax
#include <array>      // speeds

#include <motionlang/geometry/vec.hpp>
#include <motionlang/kinematics/sinc_parts.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

///     v_part = mean_t | mean_j (x_j(t+1) - x_j(t)) |,   joints j of the part
/// joints  (frames, 22)
/// result  by SincPart; in the unit of the joints, per frame
/// Throws  shape_error 205, numeric_error 302 of fewer than two frames
template <Scalar S>
std::array<S, sinc_part_count> sinc_part_speeds(std::span<const Vec3<S>> joints) {
  constexpr std::size_t n = sinc_part_of_joint.size();
  const std::size_t frames = joints.size() / n;
  if (joints.size() != frames * n)
    raise<shape_error>(205, "sinc_part_speeds: ", joints.size(), " joints are no frames of ", n);
  if (frames < 2) raise<numeric_error>(302, "sinc_part_speeds: of ", frames, " frames");
  std::array<S, sinc_part_count> count{}, out{};
  for (const SincPart p : sinc_part_of_joint) count[static_cast<std::size_t>(p)] += S(1);
  for (std::size_t t = 0; t + 1 < frames; ++t) {
    std::array<Vec3<S>, sinc_part_count> ways{};
    for (std::size_t j = 0; j < n; ++j) {
      auto& way = ways[static_cast<std::size_t>(sinc_part_of_joint[j])];
      way = way + (joints[(t + 1) * n + j] - joints[t * n + j]);
    }
    for (std::size_t p = 0; p < sinc_part_count; ++p) out[p] += norm(ways[p]) / count[p] / static_cast<S>(frames - 1);
  }
  return out;
}

/// The parts that are faster than `threshold` on a scale from the slowest part, 0, to the fastest, 1; none if all are as
/// fast. The published threshold was found by looking.
template <Scalar S>
SincParts moving_sinc_parts(const std::array<S, sinc_part_count>& speeds, double threshold = 0.65) {
  const auto [slowest, fastest] = std::minmax_element(speeds.begin(), speeds.end());
  SincParts out;
  for (std::size_t p = 0; p < sinc_part_count; ++p) {
    out[p] = static_cast<double>(speeds[p] - *slowest) > threshold * static_cast<double>(*fastest - *slowest);
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
