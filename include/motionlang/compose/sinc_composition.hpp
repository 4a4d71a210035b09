// SPDX-License-Identifier: MIT
/// One motion out of two: each gives the body parts that its action needs.
///
///     compose_motions(walk, parts_of_walk, wave, parts_of_wave)   // walks, the right arm waves
///
/// Source  SINC (Athanasiou et al., ICCV 2023), combine_motions; spec sinc.md 7
/// Rule    1. The motion with fewer parts is the second one (a tie: as given) and overrides.
///         2. Legs and pelvis stay together: with the second if it has any of them, else with the first.
///         3. What the second does not have comes from the first. The path over the ground is of the one with the legs.
#pragma once

#include <motionlang/features/smplvelp.hpp>
#include <motionlang/kinematics/sinc_parts.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// Where the longer motion is cut: at its end, as in training, or at both ends, as published compositions of generated
/// motions are.
enum class SincTrim { end, both_ends };

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
  const SincParts lower = sinc_parts(SincPart::global, SincPart::left_leg, SincPart::right_leg);
  const bool legs_of_b = (parts_b & lower).any();
  const SincParts of_b = legs_of_b ? parts_b | lower : parts_b & ~lower;
  const std::size_t frames = std::min(a.trans.size(), b.trans.size());
  const auto start = [&](const SmplVelpMotion<S>& m) {
    return trim == SincTrim::both_ends ? (m.trans.size() - frames) / 2 : 0;
  };
  const std::size_t from_a = start(a), from_b = start(b);
  SmplVelpMotion<S> out;
  for (std::size_t f = 0; f < frames; ++f) {
    for (std::size_t j = 0; j < joints; ++j) {
      out.rotations.push_back(has(of_b, sinc_part_of_joint[j]) ? b.rotations[(from_b + f) * joints + j]
                                                               : a.rotations[(from_a + f) * joints + j]);
    }
    out.trans.push_back(legs_of_b ? b.trans[from_b + f] : a.trans[from_a + f]);
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
