// SPDX-License-Identifier: MIT
// Bodies of smplrifke.hpp.
#pragma once

#include <motionlang/features/smplrifke.hpp>
#include <motionlang/geometry/so3.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<double> smplrifke_from_motion(const Motion& motion) {
  if (motion.skeleton.names != smpl24_skeleton().names || motion.skeleton.parents != smpl24_skeleton().parents) {
    raise<config_error>(103, "smplrifke_from_motion: the ", motion.skeleton.size(), " joints of '", motion.name,
                        "' are not the 24 of SMPL; retarget first");
  }
  const auto z_up = axis_rotation(0, std::numbers::pi / 2);  // (x, y, z) -> (x, -z, y)
  std::vector<Matrix3<double>> rotations;
  std::vector<Vec3<double>> joints;
  JointTransforms<double> world;
  for (Index f = 0; f < motion.frames(); ++f) {
    motion.world(f, world);
    for (const Vec3<double>& p : world.position) joints.push_back({p.x, -p.z, p.y});
    rotations.push_back(z_up * world.rotation[0]);
    for (const auto& q : motion.rotations(f).subspan(1, smplrifke_rotations - 1)) rotations.push_back(to_matrix(q));
  }
  return smplrifke_features(std::span<const Matrix3<double>>(rotations), std::span<const Vec3<double>>(joints));
}

MOTIONLANG_NAMESPACE_END
