// SPDX-License-Identifier: MIT
// Bodies of on_smpl.hpp.
#pragma once

#include <motionlang/kinematics/on_smpl.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Motion on_smpl(const Motion& motion, RetargetReport* report) {
  const Skeleton &own = motion.skeleton, &smpl = smpl24_skeleton();
  std::vector<std::size_t> from;  // our joint for each of SMPL's
  for (int j = 0; j < smpl.size(); ++j) {
    const int k = own.find(smpl.name(j));
    const bool same = k >= 0 && own.size() == smpl.size() && (j == 0) == (own.parent(k) < 0) &&
                      (j == 0 || own.name(own.parent(k)) == smpl.name(smpl.parent(j)));
    if (!same) {
      const SkeletonMap map(own);
      if (report != nullptr) *report = map.report();
      return retarget(motion, map);
    }
    from.push_back(static_cast<std::size_t>(k));
  }
  Motion out{smpl, motion.fps, motion.root, {}, motion.name};
  for (std::size_t j = 0; j < from.size(); ++j) out.skeleton.offsets[j] = own.offsets[from[j]];
  for (Index f = 0; f < motion.frames(); ++f) {
    for (const std::size_t k : from) out.local.push_back(motion.rotations(f)[k]);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
