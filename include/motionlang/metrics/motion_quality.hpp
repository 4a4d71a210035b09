// SPDX-License-Identifier: MIT
/// How physical a clip looks, without a reference: foot skating, acceleration, jitter, penetration of the floor,
/// constancy of bones. Published figures use many definitions; the ones used here are written down with each function.
/// Y up, metres.
#pragma once

#include <algorithm>  // max
#include <span>       // positions
#include <vector>     // lengths

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
  void validate() const {
    if (joints <= 0 || std::ssize(positions) % joints != 0) {
      raise<shape_error>(205, "JointTracks: ", positions.size(), " positions are not rows of ", joints);
    }
    if (!(fps > 0)) raise<config_error>(101, "JointTracks: frame rate ", fps);
  }
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
inline FootSkate foot_skate(const JointTracks& tracks, std::span<const ContactJoint> feet = smpl_contact_joints,
                            double floor = 0, double limit = 0.5) {
  tracks.validate();
  Index contacts = 0, skating = 0, looked_at = 0;
  double sum = 0;
  for (const ContactJoint& foot : feet) {
    if (foot.joint < 0 || foot.joint >= tracks.joints) {
      raise<shape_error>(203, "foot_skate: joint ", foot.joint, " of ", tracks.joints);
    }
    for (Index f = 0; f + 1 < tracks.frames(); ++f, ++looked_at) {
      const auto slide = detail::slide(tracks.positions, tracks.joints, f, foot, floor);
      if (!slide.low) continue;
      const double speed = slide.length() * tracks.fps;
      ++contacts;
      sum += speed;
      skating += speed > limit ? 1 : 0;
    }
  }
  if (contacts == 0) return {};
  const auto n = static_cast<double>(contacts);
  return {sum / n, static_cast<double>(skating) / n, n / static_cast<double>(looked_at)};
}

/// Mean size of the second derivative of joint positions, m/s^2. ACTOR prints it per frame: fps = 1.
///     |p_{f+2} - 2 p_{f+1} + p_f| fps^2,   averaged over frames and joints; 0 for fewer than three frames
inline double mean_acceleration(const JointTracks& tracks) {
  tracks.validate();
  double sum = 0;
  for (Index f = 0; f + 2 < tracks.frames(); ++f) {
    for (Index j = 0; j < tracks.joints; ++j) {
      sum += norm((tracks.at(f + 2, j) - tracks.at(f + 1, j)) - (tracks.at(f + 1, j) - tracks.at(f, j)));
    }
  }
  const Index terms = std::max<Index>(tracks.frames() - 2, 0) * tracks.joints;
  return terms == 0 ? 0 : sum / static_cast<double>(terms) * tracks.fps * tracks.fps;
}

/// Mean size of the third derivative of joint positions, m/s^3.
///     |p_{f+3} - 3 p_{f+2} + 3 p_{f+1} - p_f| fps^3,   averaged over frames and joints; 0 for fewer than four frames
inline double jitter(const JointTracks& tracks) {
  tracks.validate();
  double sum = 0;
  for (Index f = 0; f + 3 < tracks.frames(); ++f) {
    for (Index j = 0; j < tracks.joints; ++j) {
      sum += norm((tracks.at(f + 3, j) - tracks.at(f, j)) + 3.0 * (tracks.at(f + 1, j) - tracks.at(f + 2, j)));
    }
  }
  const Index terms = std::max<Index>(tracks.frames() - 3, 0) * tracks.joints;
  return terms == 0 ? 0 : sum / static_cast<double>(terms) * tracks.fps * tracks.fps * tracks.fps;
}

struct Penetration {
  double mean = 0;     // depth of the lowest joint, averaged over all frames (0 where nothing is below), metres
  double deepest = 0;  // metres
  double ratio = 0;    // share of frames in which something is below
};

/// How far joints are below the floor.
inline Penetration penetration(const JointTracks& tracks, double floor = 0) {
  tracks.validate();
  Penetration p;
  for (Index f = 0; f < tracks.frames(); ++f) {
    double depth = 0;
    for (Index j = 0; j < tracks.joints; ++j) depth = std::max(depth, floor - tracks.at(f, j).y);
    p.mean += depth;
    p.deepest = std::max(p.deepest, depth);
    p.ratio += depth > 0 ? 1 : 0;
  }
  const auto frames = static_cast<double>(std::max<Index>(tracks.frames(), 1));
  p.mean /= frames;
  p.ratio /= frames;
  return p;
}

/// How much the lengths of bones change: the largest |length - mean| / mean over frames and bones. 0 for a motion that
/// was made by rotations; generated joint positions are not so good. A bone of mean length 0 does not count.
/// Throws as JointTracks::validate, shape_error 204 if there is not one parent for each joint, 203 for a parent out of
/// range.
inline double bone_length_deviation(const JointTracks& tracks, std::span<const int> parents) {
  tracks.validate();
  if (std::ssize(parents) != tracks.joints) {
    raise<shape_error>(204, "bone_length_deviation: ", parents.size(), " parents for ", tracks.joints, " joints");
  }
  double worst = 0;
  std::vector<double> lengths(static_cast<std::size_t>(tracks.frames()));
  for (Index j = 0; j < tracks.joints; ++j) {
    const int parent = parents[static_cast<std::size_t>(j)];
    if (parent < 0) continue;
    if (parent >= tracks.joints) raise<shape_error>(203, "bone_length_deviation: parent ", parent, " of joint ", j);
    double mean = 0;
    for (Index f = 0; f < tracks.frames(); ++f) {
      lengths[static_cast<std::size_t>(f)] = norm(tracks.at(f, j) - tracks.at(f, parent));
      mean += lengths[static_cast<std::size_t>(f)] / static_cast<double>(tracks.frames());
    }
    for (const double length : lengths) worst = mean > 0 ? std::max(worst, std::abs(length - mean) / mean) : worst;
  }
  return worst;
}

struct MotionQuality {
  FootSkate feet;
  double jitter = 0;
  Penetration below_floor;
};
/// All of it for a clip on SMPL's joints (or on others, with their feet) that stands on y = `floor`.
inline MotionQuality motion_quality(const Motion& motion, std::span<const ContactJoint> feet = smpl_contact_joints,
                                    double floor = 0) {
  const std::vector<Vec3<double>> positions = motion.positions();
  const JointTracks tracks{positions, motion.skeleton.size(), motion.fps};
  return {foot_skate(tracks, feet, floor), jitter(tracks), penetration(tracks, floor)};
}

MOTIONLANG_NAMESPACE_END
