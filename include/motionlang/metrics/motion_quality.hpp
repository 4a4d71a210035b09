// SPDX-License-Identifier: MIT
/// How physical a clip looks, without a reference: foot skating, acceleration, jitter, penetration of the floor,
/// constancy of bones. Published figures use many definitions; the ones used here are written down with each function.
/// Y up, metres.
#pragma once

#include <span>  // positions

#include <motionlang/geometry/vec.hpp>
#include <motionlang/kinematics/foot_contact.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Joint positions of a clip, (frames, joints), and how fast they follow each other.
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

/// Sliding feet. A joint is in contact between frames f and f + 1 if it is below its height in both; its speed there is
/// the horizontal distance between the two times fps. `limit` (m/s) counts a contact as skating: 0.5 m/s are the 2.5 cm
/// per frame at 20 fps of GMD (Karunratanakul et al., ICCV 2023).
/// Without contacts everything is 0. Throws as JointTracks::validate, shape_error 203 for a joint out of range.
FootSkate foot_skate(const JointTracks& tracks, std::span<const ContactJoint> feet = smpl_contact_joints,
                     double floor = 0, double limit = 0.5);

/// Mean size of the second derivative of joint positions, m/s^2. ACTOR prints it per frame: fps = 1.
///     |p_{f+2} - 2 p_{f+1} + p_f| fps^2,   averaged over frames and joints; 0 for fewer than three frames
double mean_acceleration(const JointTracks& tracks);

/// Mean size of the third derivative of joint positions, m/s^3.
///     |p_{f+3} - 3 p_{f+2} + 3 p_{f+1} - p_f| fps^3,   averaged over frames and joints; 0 for fewer than four frames
double jitter(const JointTracks& tracks);

struct Penetration {
  double mean = 0;     // depth of the lowest joint, averaged over all frames (0 where nothing is below), metres
  double deepest = 0;  // metres
  double ratio = 0;    // share of frames in which something is below
};

/// How far joints are below the floor.
Penetration penetration(const JointTracks& tracks, double floor = 0);

/// How much the lengths of bones change: the largest |length - mean| / mean over frames and bones. 0 for a motion that
/// was made by rotations; generated joint positions are not so good. A bone of mean length 0 does not count.
/// Throws as JointTracks::validate, shape_error 204 if there is not one parent for each joint, 203 for a parent out of
/// range.
double bone_length_deviation(const JointTracks& tracks, std::span<const int> parents);

struct MotionQuality {
  FootSkate feet;
  double jitter = 0;
  Penetration below_floor;
};
/// All of it for a clip on SMPL's joints (or on others, with their feet) that stands on y = `floor`.
MotionQuality motion_quality(const Motion& motion, std::span<const ContactJoint> feet = smpl_contact_joints,
                             double floor = 0);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/motion_quality.ipp>
#endif
