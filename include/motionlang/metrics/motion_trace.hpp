// SPDX-License-Identifier: MIT
/// A motion as an eye sees it: curves over time of the body's movement, and faults of any movement. SMPL's joints, Y
/// up, metres, seconds, degrees. The floor is y = 0.
///
///     const MotionTrace t = trace_motion(motion);
///     const double degrees = t.turned(), seconds = longest_hover(t);
#pragma once

#include <array>   // two sides
#include <cstdio>  // snprintf
#include <string>  // faults
#include <vector>  // curves

#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// A number as text with two decimals.
inline std::string two_digits(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f", x);
  return text;
}

}  // namespace detail

/// An arm or a leg at each frame.
struct ArmTrace {
  std::vector<double> raised;       // height of the wrist above its shoulder, in the world or along a bent trunk
  std::vector<double> elbow;        // 180: straight
  std::vector<double> to_mouth;     // distance of the wrist from the head joint
  std::vector<Vec3<double>> hand;   // wrist seen from the chest: x left, y up, z forward
  std::vector<double> speed;        // of the wrist, seen from the pelvis
  std::vector<double> above_floor;  // wrist
};
struct LegTrace {
  std::vector<double> height;  // of the foot above its standing height
  std::vector<double> knee;    // height of the knee
  std::vector<double> yaw;     // heading of the foot, continuous
  std::vector<double> speed;   // of the ankle, seen from the pelvis
  std::vector<double> ahead;   // distance of the ankle in front of the pelvis, along the heading
};

struct MotionTrace {
  double fps = 20;
  std::vector<double> over_floor;          // of the whole body (kinematics/floor_fix.hpp)
  std::vector<double> pelvis, head;        // heights
  std::vector<double> heading;             // continuous, left is positive; 0 in the first frame
  std::vector<double> forward, left;       // displacement of the root, relative to the first heading
  std::vector<double> lean;                // of the trunk from upright, in any direction
  std::vector<double> twist;               // of the chest relative to the pelvis, left is positive
  std::vector<double> look_left, look_up;  // of the head relative to the chest
  std::vector<double> upside_down;         // height of the pelvis above the head
  std::vector<double> step;                // displacement of the root over the floor to the next frame
  std::vector<double> joint_speed;         // of the fastest joint, to the next frame
  std::vector<double> hands_apart;         // distance of the wrists
  std::array<ArmTrace, 2> arms{};          // left, right
  std::array<LegTrace, 2> legs{};

  std::size_t frames() const { return pelvis.size(); }
  double seconds() const { return static_cast<double>(frames()) / fps; }
  double turned() const { return heading.empty() ? 0 : heading.back(); }
  /// Mean speed of the root over the floor.
  double speed() const;
};

/// Throws config_error 103 for a skeleton without SMPL's joints.
MotionTrace trace_motion(const Motion& motion);
/// Frames [first, last) of it. Displacement and heading still count from the first frame of the whole.
MotionTrace part_of(const MotionTrace& trace, std::size_t first, std::size_t last);

/// A time in which nothing touches the floor.
struct Flight {
  std::size_t first = 0, last = 0;  // frames [first, last)
  double seconds = 0, peak = 0;     // duration, height above the floor
  double off_arc = 0;               // root mean square distance of the pelvis from a thrown body, metres
  bool lands = false;               // before the end
};
/// Flights at least 5 cm above the floor. `lowest`: only those with this peak or more.
std::vector<Flight> flights(const MotionTrace& trace, double lowest = 0.05);

double longest_hover(const MotionTrace& trace);         // seconds, above 5 cm
double sunken_seconds(const MotionTrace& trace);        // deeper than 4 cm
double still_share(const MotionTrace& trace);           // of frames in which no joint is faster than 15 cm/s
double turned_on_flat_soles(const MotionTrace& trace);  // degrees, by both feet at the same time

/// Limits beyond which something looks wrong. They come from 796 recorded segments on the floor (`motionlang judge
/// --clips`): 98 % hover less, none sinks in for so long, and 94 % stand still less. 99 % turn less on two feet, and 91
/// % of flights are nearer to their arc.
struct EyeLimits {
  double hover = 0.75, sunken = 0.25, still = 0.7, flat_turn = 55, off_arc = 0.15;
};
/// The first fault: "hovers 1.20 s", "sinks in", ...; "" if nothing looks wrong. Standing still is not checked.
std::string look_wrong(const MotionTrace& trace, const EyeLimits& limits = {});

/// The number of times that a curve rises from below `low` to above `high`. A curve that begins above counts after it
/// has been low.
std::size_t rises(const std::vector<double>& curve, double low, double high);
/// The number of times that it turns back after a change of at least `way`.
std::size_t reversals(const std::vector<double>& curve, double way);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/motion_trace.ipp>
#endif
