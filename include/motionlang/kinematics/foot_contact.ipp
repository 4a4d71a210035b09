// SPDX-License-Identifier: MIT
// Bodies of foot_contact.hpp.
#pragma once

#include <motionlang/kinematics/foot_contact.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::uint8_t> foot_contacts(const Motion& motion, std::span<const ContactJoint> feet,
                                                        const ContactOptions& options) {
  const Index joints = motion.skeleton.size(), frames = motion.frames();
  for (const ContactJoint& foot : feet) {
    if (foot.joint < 0 || foot.joint >= joints)
      raise<shape_error>(203, "foot_contacts: joint ", foot.joint, " of ", joints);
  }
  const auto positions = motion.positions();
  std::vector<std::uint8_t> flags;
  for (Index f = 0; f < frames; ++f) {
    const Index from = std::max<Index>(0, std::min(f, frames - 2)), to = std::min(from + 1, frames - 1);
    for (const ContactJoint& foot : feet) {
      auto at = [&](Index frame) { return positions[static_cast<std::size_t>(frame * joints + foot.joint)]; };
      const Vec3<double> step = at(to) - at(from);
      const double speed = norm(Vec3<double>{step.x, 0, step.z}) * motion.fps;
      flags.push_back(at(f).y - options.floor < foot.height && speed < options.speed ? 1 : 0);
    }
  }
  return flags;
}

MOTIONLANG_NAMESPACE_END
