// SPDX-License-Identifier: MIT
// Bodies of overlay.hpp.
#pragma once

#include <algorithm>  // equal, min

#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/overlay.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Motion overlay_parts(const Motion& base, const Motion& other, BodyParts parts) {
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
  Motion out = base;
  const Index frames = std::min(base.frames(), other.frames());
  out.root.resize(static_cast<std::size_t>(frames));
  out.local.resize(static_cast<std::size_t>(frames * base.skeleton.size()));
  for (Index f = 0; f < frames; ++f) {
    const auto from = other.rotations(f);
    const auto to = out.rotations(f);
    for (std::size_t j = 1; j < to.size(); ++j) {
      if (parts.has(smpl_part_of_joint[j])) to[j] = from[j];
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
