// SPDX-License-Identifier: MIT
/// Detects contacts of feet with the floor. Y up, metres.
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
/// The feet of SMPL and HumanML3D. In a standing foot, the ankle is about 7 cm and the toe joint 1 to 2 cm high.
inline constexpr double smpl_ankle_contact = 0.10, smpl_toe_contact = 0.05;
/// Ankles and toes of SMPL (and HumanML3D).
inline constexpr ContactJoint smpl_contact_joints[] = {
    {7, smpl_ankle_contact}, {8, smpl_ankle_contact}, {10, smpl_toe_contact}, {11, smpl_toe_contact}};

namespace detail {

/// The displacement of a joint over the floor from one frame to the next; `low` if it is below its height in both.
struct Slide {
  bool low = false;
  Vec3<double> step{};
  double length() const { return norm(step); }
};
/// positions (frames, joints); frame + 1 must be a frame, too.
inline Slide slide(std::span<const Vec3<double>> positions, Index joints, Index frame, const ContactJoint& foot,
                   double floor) {
  const auto &a = positions[static_cast<std::size_t>(frame * joints + foot.joint)],
             &b = positions[static_cast<std::size_t>((frame + 1) * joints + foot.joint)];
  return {std::max(a.y, b.y) - floor < foot.height, {b.x - a.x, 0, b.z - a.z}};
}

}  // namespace detail

struct ContactOptions {
  double floor = 0;
  double speed = 0.6;  // m/s over the floor; a faster joint is not in contact
};

/// (frames, feet): 1 if a foot is below its height and slower than options.speed between a frame and the next (for the
/// last frame: the one before). Throws shape_error 203 for a joint out of range.
std::vector<std::uint8_t> foot_contacts(const Motion& motion, std::span<const ContactJoint> feet = smpl_contact_joints,
                                        const ContactOptions& options = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/foot_contact.ipp>
#endif
