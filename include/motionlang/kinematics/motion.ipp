// SPDX-License-Identifier: MIT
// Bodies of motion.hpp.
#pragma once

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void Motion::world(Index frame, JointTransforms<double>& result) const {
  forward_kinematics(skeleton, rotations(frame), root_at(frame), result);
}

MOTIONLANG_BODY std::vector<Vec3<double>> Motion::positions() const {
  std::vector<Vec3<double>> out;
  out.reserve(local.size());
  JointTransforms<double> t;
  for (Index f = 0; f < frames(); ++f) {
    world(f, t);
    out.insert(out.end(), t.position.begin(), t.position.end());
  }
  return out;
}

MOTIONLANG_BODY void Motion::validate() const {
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

MOTIONLANG_NAMESPACE_END
