// SPDX-License-Identifier: MIT
/// A clip of motion: a skeleton, a frame rate, and for each frame the root position and all local rotations.
///
/// Inside the library every clip is Y up, right-handed and in metres, and a rest pose faces +Z. Readers and writers
/// convert from and to other conventions (BVH files in centimetres, AMASS with Z up, ...). Values are double, so files
/// and features are exact to the last printed digit.
#pragma once

#include <motionlang/kinematics/forward.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The limit for rotations (frames x joints) of a clip that samples another one; 1.6 GB. More come from a mistyped
/// frame rate.
inline constexpr double max_rotations = 5e7;

struct Motion {
  Skeleton skeleton;
  double fps = 20;
  std::vector<Vec3<double>> root;         // (frames)
  std::vector<Quaternion<double>> local;  // (frames, joints), joint fastest
  std::string name{};                     // of the clip, for messages and files

  Index frames() const { return static_cast<Index>(root.size()); }
  double seconds() const { return static_cast<double>(frames()) / fps; }

  std::span<const Quaternion<double>> rotations(Index frame) const {
    const auto joints = static_cast<std::size_t>(skeleton.size());
    return std::span(local).subspan(static_cast<std::size_t>(frame) * joints, joints);
  }
  std::span<Quaternion<double>> rotations(Index frame) {
    const auto joints = static_cast<std::size_t>(skeleton.size());
    return std::span(local).subspan(static_cast<std::size_t>(frame) * joints, joints);
  }
  const Vec3<double>& root_at(Index frame) const { return root[static_cast<std::size_t>(frame)]; }

  /// Joint positions and rotations of one frame in the world.
  void world(Index frame, JointTransforms<double>& result) const;
  /// Joint positions of all frames, (frames, joints).
  std::vector<Vec3<double>> positions() const;
  /// Throws shape_error 205 if the arrays do not fit, config_error 101 unless the frame rate is positive, or if times
  /// overflow at it, numeric_error 301 on a value that is not finite and on a rotation of length 0.
  void validate() const;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/motion.ipp>
#endif
