// SPDX-License-Identifier: MIT
// Bodies of root_motion.hpp.
#pragma once

#include <motionlang/kinematics/root_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Placement placement_between(const Motion& clip, Index from, const Motion& other, Index to) {
  Placement p{turn_between(clip.rotations(from)[0], other.rotations(to)[0]), {}};
  const Vec3<double> way = other.root_at(to) - p(clip.root_at(from));
  p.shift = {way.x, 0, way.z};
  return p;
}

MOTIONLANG_BODY Motion placed(const Motion& motion, const Placement& placement) {
  Motion out = motion;
  for (Vec3<double>& r : out.root) r = placement(r);
  const Quaternion<double> turn = placement.rotation();
  for (Index f = 0; f < out.frames(); ++f) out.rotations(f)[0] = turn * out.rotations(f)[0];
  return out;
}

MOTIONLANG_BODY Motion in_place(const Motion& motion, const InPlaceOptions& options) {
  Motion out = motion;
  for (Vec3<double>& r : out.root) r = {0, options.keep_height ? r.y : motion.root_at(0).y, 0};
  return out;
}

MOTIONLANG_BODY ExtractedRoot extract_root_motion(const Motion& motion) {
  ExtractedRoot out{{motion.fps, {}, {}}, in_place(motion)};
  for (Index f = 0; f < motion.frames(); ++f) {
    const Vec3<double>& r = motion.root_at(f);
    const double before = f == 0 ? 0 : out.path.heading.back();
    const double turn = turn_between(motion.rotations(0)[0], motion.rotations(f)[0]);
    const double heading = before + std::remainder(turn - before, 2 * std::numbers::pi);
    out.path.position.push_back({r.x, 0, r.z});
    out.path.heading.push_back(heading);
    out.pose.rotations(f)[0] = Placement{-heading, {}}.rotation() * motion.rotations(f)[0];
  }
  return out;
}

MOTIONLANG_BODY Motion apply_root_motion(const Motion& pose, const RootMotion& path) {
  if (std::ssize(path.position) != pose.frames() || std::ssize(path.heading) != pose.frames()) {
    raise<shape_error>(204, "apply_root_motion: ", pose.frames(), " frames, a path of ", path.position.size(),
                       " positions and ", path.heading.size(), " headings");
  }
  Motion out = pose;
  for (Index f = 0; f < out.frames(); ++f) {
    const auto at = static_cast<std::size_t>(f);
    const Placement p{path.heading[at], path.position[at]};
    out.root[at] = p(pose.root_at(f));
    out.rotations(f)[0] = p.rotation() * pose.rotations(f)[0];
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
