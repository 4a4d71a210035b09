// SPDX-License-Identifier: MIT
/// One motion out of two: each gives the body parts that its action needs.
///
///     compose_motions(walk, parts_of_walk, wave, parts_of_wave)   // walks, the right arm waves
///
/// Source  thesis B.2.1, steps 1 to 5; SINC (Athanasiou et al., ICCV 2023) sinc/tools/frank.py combine_motions
/// Rule    1. The motion with fewer parts is the second one (a tie: as given) and overrides.
///         2. Legs and pelvis stay together: they come from the second if it has any of them, else from the first.
///         3. All other parts come from the first. The path over the ground comes from the motion with the legs.
#pragma once

#include <motionlang/features/smplvelp.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/kinematics/sinc_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The place where the longer motion is cut: at its end, as in training, or at both ends, as in published compositions
/// of generated motions.
enum class SincTrim { end, both_ends };

namespace detail {

/// The parts that motion b gives, which has fewer, and the frames at which both begin.
struct SincComposition {
  SincParts of_b;
  bool path_of_b;
  std::size_t frames, from_a, from_b;

  SincComposition(SincParts parts_b, std::size_t frames_a, std::size_t frames_b, SincTrim trim);
};

}  // namespace detail

/// a, b     22 joints each
/// result   as many frames as the shorter one has; paths are not moved onto one another
/// Throws   shape_error 205 if rotations are not 22 for each frame
template <Scalar S>
SmplVelpMotion<S> compose_motions(const SmplVelpMotion<S>& a, SincParts parts_a, const SmplVelpMotion<S>& b,
                                  SincParts parts_b, SincTrim trim = SincTrim::end) {
  if (parts_a.count() < parts_b.count()) return compose_motions(b, parts_b, a, parts_a, trim);
  constexpr std::size_t joints = sinc_part_of_joint.size();
  for (const auto* m : {&a, &b}) {
    if (m->rotations.size() == joints * m->trans.size()) continue;
    raise<shape_error>(205, "compose_motions: ", m->rotations.size(), " rotations for ", m->trans.size(), " frames");
  }
  const detail::SincComposition c(parts_b, a.trans.size(), b.trans.size(), trim);
  SmplVelpMotion<S> out;
  for (std::size_t f = 0; f < c.frames; ++f) {
    for (std::size_t j = 0; j < joints; ++j) {
      out.rotations.push_back(has(c.of_b, sinc_part_of_joint[j]) ? b.rotations[(c.from_b + f) * joints + j]
                                                                 : a.rotations[(c.from_a + f) * joints + j]);
    }
    out.trans.push_back(c.path_of_b ? b.trans[c.from_b + f] : a.trans[c.from_a + f]);
  }
  return out;
}

/// The same for clips on one skeleton, SMPL's 24 joints. A hand goes with its arm. Throws config_error 102 for other
/// skeletons or different frame rates.
Motion compose_motions(const Motion& a, SincParts parts_a, const Motion& b, SincParts parts_b,
                       SincTrim trim = SincTrim::end);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/compose/sinc_composition.ipp>
#endif
