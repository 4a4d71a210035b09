// SPDX-License-Identifier: MIT
/// Deterministic made-up motion for tests: a figure that walks, swings its arms and does not slide.
#pragma once

#include <algorithm>  // max
#include <cmath>      // sin, cos
#include <limits>     // infinity
#include <numbers>    // pi

#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>
#include <motionlang/kinematics/motion.hpp>

namespace synthetic {

namespace ml = motionlang;

struct Walk {
  int frames = 60;
  double fps = 20;
  double steps_per_second = 1.8;
  double turn = 0;  // radians per second, left positive
};

inline ml::Quaternion<double> about_x(double angle) { return ml::from_axis_angle(ml::Vec3{1.0, 0.0, 0.0}, angle); }
inline ml::Quaternion<double> about_y(double angle) { return ml::from_axis_angle(ml::Vec3{0.0, 1.0, 0.0}, angle); }
inline ml::Quaternion<double> about_z(double angle) { return ml::from_axis_angle(ml::Vec3{0.0, 0.0, 1.0}, angle); }

/// A walk of a skeleton with SMPL's joint names (24 or 22 joints). It starts at x = z = 0 towards +Z; the lower foot
/// stands still on the floor y = 0 and carries the root forward.
inline ml::Motion walk(const Walk& options = {}, const ml::Skeleton& skeleton = ml::smpl24_skeleton()) {
  using std::sin, std::cos;
  ml::Motion motion{skeleton, options.fps, {}, {}, "walk"};
  const auto joints = static_cast<std::size_t>(skeleton.size());
  motion.root.assign(static_cast<std::size_t>(options.frames), ml::Vec3{0.0, 0.0, 0.0});
  motion.local.assign(motion.root.size() * joints, ml::Quaternion<double>::identity());

  ml::JointTransforms<double> before, now;
  for (ml::Index frame = 0; frame < motion.frames(); ++frame) {
    const double t = static_cast<double>(frame) / options.fps;
    const double phase = std::numbers::pi * options.steps_per_second * t, heading = options.turn * t;
    const auto pose = motion.rotations(frame);
    auto at = [&](const char* joint) -> ml::Quaternion<double>& {
      return pose[static_cast<std::size_t>(skeleton[joint])];
    };
    at("pelvis") = about_y(heading + 0.06 * sin(phase)) * about_z(0.03 * cos(phase));
    for (const bool left : {true, false}) {
      const double p = left ? phase : phase + std::numbers::pi, side = left ? 1 : -1;
      const double swing = std::max(0.0, cos(p - 0.2));  // the leg is lifted while it moves forward
      const double hip = -0.08 - 0.42 * sin(p), knee = 0.10 + 0.85 * swing * swing;
      at(left ? "left_hip" : "right_hip") = about_x(hip);
      at(left ? "left_knee" : "right_knee") = about_x(knee);
      at(left ? "left_ankle" : "right_ankle") = about_x(-hip - knee + 0.30 * std::max(0.0, -sin(p)));
      at(left ? "left_shoulder" : "right_shoulder") = about_x(0.45 * sin(p)) * about_z(side * -1.30);
      at(left ? "left_elbow" : "right_elbow") = about_y(side * (-0.35 + 0.20 * sin(p)));
    }
    at("spine3") = about_y(-0.10 * sin(phase));
    at("head") = about_y(0.05 * sin(phase));

    // The lower foot touches the floor and stays where it was in the frame before.
    motion.world(frame, now);
    const auto l = static_cast<std::size_t>(skeleton["left_foot"]),
               r = static_cast<std::size_t>(skeleton["right_foot"]);
    const std::size_t stance = now.position[l].y < now.position[r].y ? l : r;
    ml::Vec3<double>& root = motion.root[static_cast<std::size_t>(frame)];
    root.y = 0.03 - now.position[stance].y;  // 3 cm: the sole below the foot joint
    if (frame > 0) {
      root.x = before.position[stance].x - now.position[stance].x;
      root.z = before.position[stance].z - now.position[stance].z;
    }
    motion.world(frame, before);
  }
  return motion;
}

/// The figure of `walk` stands, jumps straight up, is in the air for half a second and stands again.
inline ml::Motion jump(double fps = 60) {
  ml::Motion motion = walk({.frames = 1, .fps = fps});
  const double stand = motion.root[0].y, flight = 0.5;
  const auto frames = static_cast<int>(1.5 * fps);
  for (int frame = 1; frame < frames; ++frame) {
    const double t = frame / fps - 0.5;
    motion.root.push_back({0, stand + std::max(0.0, 0.5 * 9.81 * t * (flight - t)), 0});
    for (int j = 0; j < motion.skeleton.size(); ++j) motion.local.push_back(motion.local[static_cast<std::size_t>(j)]);
  }
  return motion;
}

/// Largest distance between the same joint in the same frame; infinity if the motions differ in size.
inline double largest_distance(const ml::Motion& a, const ml::Motion& b) {
  const auto p = a.positions(), q = b.positions();
  if (p.size() != q.size()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t i = 0; i < p.size(); ++i) worst = std::max(worst, ml::norm(p[i] - q[i]));
  return worst;
}

}  // namespace synthetic
