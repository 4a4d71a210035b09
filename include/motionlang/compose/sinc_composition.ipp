// SPDX-License-Identifier: MIT
// Bodies of sinc_composition.hpp.
#pragma once

#include <motionlang/compose/sinc_composition.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY SincComposition::SincComposition(SincParts parts_b, std::size_t frames_a, std::size_t frames_b,
                                                 SincTrim trim) {
  const SincParts lower = sinc_parts(SincPart::global, SincPart::left_leg, SincPart::right_leg);
  path_of_b = (parts_b & lower).any();
  of_b = path_of_b ? parts_b | lower : parts_b & ~lower;
  frames = std::min(frames_a, frames_b);
  const bool both_ends = trim == SincTrim::both_ends;
  from_a = both_ends ? (frames_a - frames) / 2 : 0;
  from_b = both_ends ? (frames_b - frames) / 2 : 0;
}

}  // namespace detail

MOTIONLANG_BODY Motion compose_motions(const Motion& a, SincParts parts_a, const Motion& b, SincParts parts_b,
                                       SincTrim trim) {
  if (parts_a.count() < parts_b.count()) return compose_motions(b, parts_b, a, parts_a, trim);
  detail::require_same_kind("compose_motions", a, b);
  if (a.skeleton.names != smpl24_skeleton().names)
    raise<config_error>(102, "compose_motions: '", a.name, "' is not on SMPL's 24 joints");
  const detail::SincComposition c(parts_b, a.root.size(), b.root.size(), trim);
  Motion out{a.skeleton, a.fps, {}, {}, concat_text(a.name, " + ", b.name)};
  for (std::size_t f = 0; f < c.frames; ++f) {
    const std::size_t in_a = c.from_a + f, in_b = c.from_b + f, joints = a.skeleton.names.size();
    for (std::size_t j = 0; j < joints; ++j) {
      const std::size_t wrist = j - 2;  // of a hand
      const SincPart part = sinc_part_of_joint[j < sinc_part_of_joint.size() ? j : wrist];
      out.local.push_back(has(c.of_b, part) ? b.local[in_b * joints + j] : a.local[in_a * joints + j]);
    }
    out.root.push_back(c.path_of_b ? b.root[in_b] : a.root[in_a]);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
