// SPDX-License-Identifier: MIT
/// When feet touch the floor. Y up, metres.
#pragma once

#include <algorithm>  // max
#include <cstdint>    // flags
#include <span>       // feet
#include <vector>     // flags

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A joint that may touch the floor, and the height below which it does.
struct ContactJoint {
  int joint = 0;
  double height = 0.05;  // metres above the floor
};
/// Of SMPL (and HumanML3D). When a foot stands, its ankle is about 7 cm and its toe joint 1 to 2 cm high.
inline constexpr double smpl_ankle_contact = 0.10, smpl_toe_contact = 0.05;
/// Ankles and toes of SMPL (and HumanML3D).
inline constexpr ContactJoint smpl_contact_joints[] = {
    {7, smpl_ankle_contact}, {8, smpl_ankle_contact}, {10, smpl_toe_contact}, {11, smpl_toe_contact}};

namespace detail {

/// The way of a joint over the floor from one frame to the next; `low` if it is below its height in both.
struct Slide {
  bool low = false;
  Vec3<double> step{};
  double length() const { return norm(step); }
};
/// positions (frames, joints); frame + 1 is one of them.
inline Slide slide(std::span<const Vec3<double>> positions, Index joints, Index frame, const ContactJoint& foot,
                   double floor) {
  const auto &a = positions[static_cast<std::size_t>(frame * joints + foot.joint)],
             &b = positions[static_cast<std::size_t>((frame + 1) * joints + foot.joint)];
  return {std::max(a.y, b.y) - floor < foot.height, {b.x - a.x, 0, b.z - a.z}};
}

}  // namespace detail

struct ContactOptions {
  double floor = 0;
  double speed = 0.6;  // m/s over the floor; a joint that is faster is only passing
};

/// (frames, feet): 1 where a foot is below its height and slower than options.speed between a frame and the next (the
/// last frame: the one before). Throws shape_error 203 for a joint out of range.
inline std::vector<std::uint8_t> foot_contacts(const Motion& motion,
                                               std::span<const ContactJoint> feet = smpl_contact_joints,
                                               const ContactOptions& options = {}) {
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
