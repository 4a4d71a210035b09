// SPDX-License-Identifier: MIT
/// Joint positions from the 263 numbers per frame of HumanML3D ("guoh3dfeats"); KIT's 251 alike. Only this direction so
/// far.
///
/// Source  Guo et al. (CVPR 2022), appendix; HumanML3D `recover_from_ric`; spec humanml3d-features.md 7
/// Layout  0 yaw velocity (half angle, rad per frame), 1:3 root velocity x, z, 3 root height, 4:3J+1 positions of
///         joints 1 ... J-1 in the root's frame, then rotations, velocities, contacts, which are not needed here
#pragma once

#include <cmath>   // sin, cos
#include <span>    // features
#include <vector>  // joints

#include <motionlang/core/shape.hpp>
#include <motionlang/geometry/vec.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// features (frames, width), not normalised -> joints (frames, joints), Y up, metres as the features have them.
///     a_t = sum_{s<t} f[s, 0];   p_t += Ry(-2 a_t) (f[t-1, 1], 0, f[t-1, 2]), p_t.y = f[t, 3]
///     X_{t,j} = Ry(-2 a_t) ric_{t,j} + (p_t.x, 0, p_t.z),   X_{t,0} = p_t
/// Throws shape_error 205 if the width does not divide the values or is too small.
template <Scalar S>
std::vector<Vec3<S>> guoh3d_joints(std::span<const S> features, Index width = 263, Index joints = 22) {
  if (width < 4 + 3 * (joints - 1) || static_cast<Index>(features.size()) % width != 0) {
    raise<shape_error>(205, "guoh3d_joints: ", features.size(), " values for frames of ", width);
  }
  const auto frames = features.size() / static_cast<std::size_t>(width);
  std::vector<Vec3<S>> out;
  S angle{};
  Vec3<S> root{};
  for (std::size_t t = 0; t < frames; ++t) {
    const S* f = &features[t * static_cast<std::size_t>(width)];
    if (t > 0) angle += f[-width];
    const S c = std::cos(2 * angle), s = std::sin(2 * angle);
    auto turned = [&](S x, S z) { return Vec3<S>{x * c - z * s, S(0), x * s + z * c}; };
    if (t > 0) root = root + turned(f[1 - width], f[2 - width]);
    root.y = f[3];
    out.push_back(root);
    for (Index j = 1; j < joints; ++j) {
      const S* p = f + 4 + 3 * (j - 1);
      const Vec3<S> v = turned(p[0], p[2]);
      out.push_back({v.x + root.x, p[1], v.z + root.z});
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
