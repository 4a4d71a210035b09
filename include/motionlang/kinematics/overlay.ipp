// SPDX-License-Identifier: MIT
// Bodies of overlay.hpp.
#pragma once

#include <algorithm>  // equal, max, min

#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/overlay.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline void check_overlay(const Motion& base, const Motion& other) {
  const auto& names = base.skeleton.names;
  const auto& smpl = smpl24_skeleton().names;
  if (names != other.skeleton.names || names.size() > smpl.size() ||
      !std::equal(names.begin(), names.end(), smpl.begin())) {
    raise<config_error>(103, "overlay_parts: '", base.name, "' and '", other.name,
                        "' are not on one skeleton of SMPL's joints");
  }
  if (base.fps != other.fps) {
    raise<config_error>(102, "overlay_parts: '", base.name, "' has ", base.fps, " frames per second, '", other.name,
                        "' ", other.fps);
  }
}

}  // namespace detail

MOTIONLANG_BODY Motion overlay_parts(const Motion& base, const Motion& other, BodyParts parts) {
  detail::check_overlay(base, other);
  Motion out = base;
  const Index frames = std::min(base.frames(), other.frames());
  out.root.resize(static_cast<std::size_t>(frames));
  out.local.resize(static_cast<std::size_t>(frames * base.skeleton.size()));
  return overlay_parts_for_a_while(out, other, parts, 0, 0);
}

MOTIONLANG_BODY Motion overlay_parts_for_a_while(const Motion& base, const Motion& other, BodyParts parts, Index first,
                                                 Index blend) {
  detail::check_overlay(base, other);
  if (first < 0 || blend < 0)
    raise<config_error>(101, "overlay_parts_for_a_while: first ", first, ", blend ", blend, ": both are 0 or more");
  Motion out = base;
  const Index frames = std::max<Index>(std::min(base.frames() - first, other.frames()), 0);
  for (Index f = 0; f < frames; ++f) {
    const double share = std::min(1.0, static_cast<double>(std::min(f, frames - 1 - f) + 1) /
                                           static_cast<double>(blend + 1));  // of the other motion
    const auto from = other.rotations(f);
    const auto to = out.rotations(first + f);
    for (std::size_t j = 1; j < to.size(); ++j) {
      if (parts.has(smpl_part_of_joint[j])) to[j] = share < 1 ? slerp(to[j], from[j], share) : from[j];
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
