// SPDX-License-Identifier: MIT
/// The physical plausibility of a clip, without a reference: foot skating, acceleration, jitter, penetration of the
/// floor, constancy of bones. Published figures use many definitions; each function states its own. Y up, metres.
#pragma once

#include <span>  // positions

#include <motionlang/geometry/vec.hpp>
#include <motionlang/kinematics/foot_contact.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Joint positions of a clip, (frames, joints), and its frame rate.
struct JointTracks {
  std::span<const Vec3<double>> positions;
  Index joints = 0;
  double fps = 20;

  Index frames() const { return std::ssize(positions) / joints; }
  const Vec3<double>& at(Index frame, Index joint) const {
    return positions[static_cast<std::size_t>(frame * joints + joint)];
  }
  /// Throws shape_error 205 unless the positions are rows of `joints`, config_error 101 unless fps > 0.
  void validate() const;
};

struct FootSkate {
  double speed = 0;    // mean horizontal speed of joints in contact, m/s; divide by fps for metres per frame
  double ratio = 0;    // share of contacts faster than the limit
  double contact = 0;  // share of frames x joints in contact
};

/// Sliding feet. A joint is in contact between frames f and f + 1 if it is below its height in both. Its speed there is
/// its horizontal displacement times fps. A contact faster than `limit` (m/s) is skating: 0.5 m/s are the 2.5 cm per
/// frame at 20 fps of GMD (Karunratanakul et al., ICCV 2023). Without contacts everything is 0. Throws as
/// JointTracks::validate, and shape_error 203 for a joint out of range.
FootSkate foot_skate(const JointTracks& tracks, std::span<const ContactJoint> feet = smpl_contact_joints,
                     double floor = 0, double limit = 0.5);

/// Mean size of the second derivative of joint positions, m/s^2. ACTOR prints it per frame: use fps = 1.
///     |p_{f+2} - 2 p_{f+1} + p_f| fps^2,   averaged over frames and joints; 0 for fewer than three frames
double mean_acceleration(const JointTracks& tracks);

/// Mean size of the third derivative of joint positions, m/s^3.
///     |p_{f+3} - 3 p_{f+2} + 3 p_{f+1} - p_f| fps^3,   averaged over frames and joints; 0 for fewer than four frames
double jitter(const JointTracks& tracks);

struct Penetration {
  double mean = 0;     // depth of the lowest joint, averaged over all frames (0 if nothing is below), metres
  double deepest = 0;  // metres
  double ratio = 0;    // share of frames with a joint below
};

/// The depth of joints below the floor.
Penetration penetration(const JointTracks& tracks, double floor = 0);

/// The change of the lengths of bones: the largest |length - mean| / mean over frames and bones. It is 0 for a motion
/// made by rotations, and larger for generated joint positions. A bone of mean length 0 does not count. Throws as
/// JointTracks::validate, shape_error 204 if there is not one parent for each joint, and 203 for a parent out of range.
double bone_length_deviation(const JointTracks& tracks, std::span<const int> parents);

struct MotionQuality {
  FootSkate feet;
  double jitter = 0;
  Penetration below_floor;
};
/// All measures of a clip on SMPL's joints (or on others, with their feet) whose floor is y = `floor`.
MotionQuality motion_quality(const Motion& motion, std::span<const ContactJoint> feet = smpl_contact_joints,
                             double floor = 0);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/motion_quality.ipp>
#endif
