// SPDX-License-Identifier: MIT
/// A clip of motion: a skeleton, a frame rate, and for each frame the root position and all local rotations.
///
/// Inside the library every clip is Y up, right-handed, in metres, and a rest pose faces +Z. Readers and writers
/// convert at the edge (BVH files in centimetres, AMASS with Z up, ...). Double precision: files and features are exact
/// to the last printed digit.
#pragma once

#include <motionlang/kinematics/forward.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Rotations (frames x joints) of a clip that is made by sampling another; 1.6 GB. More are a frame rate typed wrong.
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
  void world(Index frame, JointTransforms<double>& result) const {
    forward_kinematics(skeleton, rotations(frame), root_at(frame), result);
  }
  /// Joint positions of all frames, (frames, joints).
  std::vector<Vec3<double>> positions() const {
    std::vector<Vec3<double>> out;
    out.reserve(local.size());
    JointTransforms<double> t;
    for (Index f = 0; f < frames(); ++f) {
      world(f, t);
      out.insert(out.end(), t.position.begin(), t.position.end());
    }
    return out;
  }
  /// Throws shape_error 205 if the arrays do not fit, config_error 101 unless the frame rate is positive, or if times
  /// overflow at it, numeric_error 301 on a value that is not finite and on a rotation of length 0.
  void validate() const {
    skeleton.validate();
    if (local.size() != root.size() * static_cast<std::size_t>(skeleton.size())) {
      raise<shape_error>(205, "Motion '", name, "': ", local.size(), " rotations for ", frames(), " frames of ",
                         skeleton.size(), " joints");
    }
    for (int j = 0; j < skeleton.size(); ++j) {
      const auto o =
          skeleton.ends.empty() ? skeleton.offset(j) : skeleton.offset(j) + skeleton.ends[static_cast<std::size_t>(j)];
      if (!std::isfinite(o.x + o.y + o.z))
        raise<numeric_error>(301, "Motion '", name, "': the offset of joint '", skeleton.name(j), "' is not finite");
    }
    const double seconds_and_one_frame = static_cast<double>(frames() + 1) / fps;
    if (!(fps > 0 && std::isfinite(fps) && std::isfinite(seconds_and_one_frame)))
      raise<config_error>(101, "Motion '", name, "': frame rate ", fps);
    for (std::size_t f = 0; f < root.size(); ++f) {
      const auto& r = root[f];
      if (!std::isfinite(r.x + r.y + r.z))
        raise<numeric_error>(301, "Motion '", name, "': root position of frame ", f, " is not finite");
    }
    for (std::size_t i = 0; i < local.size(); ++i) {
      const auto& q = local[i];
      const bool finite = std::isfinite(q.w + q.x + q.y + q.z);
      if (!finite || dot(q, q) < 1e-12) {
        const std::size_t joints = skeleton.parents.size();
        raise<numeric_error>(301, "Motion '", name, "': rotation of joint '", skeleton.names[i % joints], "' in frame ",
                             i / joints, finite ? " has length 0" : " is not finite");
      }
    }
  }
};

MOTIONLANG_NAMESPACE_END
