// SPDX-License-Identifier: MIT
// Bodies of motion_quality.hpp.
#pragma once

#include <algorithm>  // max
#include <vector>     // lengths

#include <motionlang/metrics/motion_quality.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void JointTracks::validate() const {
  if (joints <= 0 || std::ssize(positions) % joints != 0) {
    raise<shape_error>(205, "JointTracks: ", positions.size(), " positions are not rows of ", joints);
  }
  if (!(fps > 0)) raise<config_error>(101, "JointTracks: frame rate ", fps);
}

MOTIONLANG_BODY FootSkate foot_skate(const JointTracks& tracks, std::span<const ContactJoint> feet, double floor,
                                     double limit) {
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

MOTIONLANG_BODY double mean_acceleration(const JointTracks& tracks) {
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

MOTIONLANG_BODY double jitter(const JointTracks& tracks) {
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

MOTIONLANG_BODY Penetration penetration(const JointTracks& tracks, double floor) {
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

MOTIONLANG_BODY double bone_length_deviation(const JointTracks& tracks, std::span<const int> parents) {
  tracks.validate();
  if (std::ssize(parents) != tracks.joints) {
    raise<shape_error>(204, "bone_length_deviation: ", counted(parents.size(), "parent"), " for ",
                       counted(tracks.joints, "joint"));
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

MOTIONLANG_BODY MotionQuality motion_quality(const Motion& motion, std::span<const ContactJoint> feet, double floor) {
  const std::vector<Vec3<double>> positions = motion.positions();
  const JointTracks tracks{positions, motion.skeleton.size(), motion.fps};
  return {foot_skate(tracks, feet, floor), jitter(tracks), penetration(tracks, floor)};
}

MOTIONLANG_NAMESPACE_END
