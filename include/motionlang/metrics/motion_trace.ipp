// SPDX-License-Identifier: MIT
// Bodies of motion_trace.hpp.
#pragma once

#include <algorithm>  // max, min
#include <cmath>      // atan2
#include <numbers>    // pi

#include <motionlang/geometry/degree.hpp>
#include <motionlang/kinematics/floor_fix.hpp>
#include <motionlang/kinematics/loops.hpp>
#include <motionlang/metrics/motion_trace.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// An angle in degrees, as near as possible to the one before.
inline double continued(double angle, const std::vector<double>& curve) {
  return curve.empty() ? angle : curve.back() + std::remainder(angle - curve.back(), 360.0);
}
inline double yaw_of(const Vec3<double>& v) { return std::atan2(v.x, v.z) / degree; }
inline double angle_at(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  return std::acos(std::clamp(dot(normalized(a - b), normalized(c - b)), -1.0, 1.0)) / degree;
}

/// Root mean square distance of a curve from the nearest parabola of a thrown body, y'' = -g.
inline double off_arc(std::span<const double> y, double fps) {
  const auto n = static_cast<double>(y.size());
  if (y.size() < 4) return 0;
  std::vector<double> rest;  // without gravity: a straight line is left
  double mean = 0, slope = 0, spread = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double t = static_cast<double>(i) / fps;
    rest.push_back(y[i] + 0.5 * 9.81 * t * t);
    mean += rest.back() / n;
  }
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double t = (static_cast<double>(i) - (n - 1) / 2) / fps;
    slope += t * rest[i], spread += t * t;
  }
  slope /= spread;
  double sum = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double e = rest[i] - mean - slope * (static_cast<double>(i) - (n - 1) / 2) / fps;
    sum += e * e;
  }
  return std::sqrt(sum / n);
}

}  // namespace detail

MOTIONLANG_BODY double MotionTrace::speed() const {
  double way = 0;
  for (const double s : step) way += s;
  return frames() < 2 ? 0 : way * fps / static_cast<double>(frames() - 1);
}

MOTIONLANG_BODY MotionTrace trace_motion(const Motion& m) {
  if (m.skeleton.size() < 22 || known_legs(m.skeleton).data() != std::data(smpl_legs))
    raise<config_error>(103, "trace_motion: '", m.name, "' is not on SMPL's joints");
  MotionTrace t;
  t.fps = m.fps;
  t.over_floor = heights_over_floor(m);
  JointTransforms<double> world;
  std::vector<Vec3<double>> before;
  double first_heading = 0;
  for (Index f = 0; f < m.frames(); ++f) {
    m.world(f, world);
    const auto& p = world.position;
    const auto seen_from = [&](std::size_t joint, const Vec3<double>& v) {
      return rotate(inverse(to_quaternion(world.rotation[joint])), v);
    };
    const double heading = detail::heading(m.rotations(f)[0]);
    if (f == 0) first_heading = heading;
    t.heading.push_back(detail::continued((heading - first_heading) / degree, t.heading));
    const auto way = rotate(detail::turn(-first_heading), m.root_at(f) - m.root_at(0));
    t.forward.push_back(way.z), t.left.push_back(way.x);
    t.pelvis.push_back(p[0].y), t.head.push_back(p[15].y), t.upside_down.push_back(p[0].y - p[15].y);
    const Vec3<double> up = world.rotation[9] * Vec3<double>{0, 1, 0};
    t.lean.push_back(std::acos(std::clamp(up.y, -1.0, 1.0)) / degree);
    t.twist.push_back(detail::yaw_of(seen_from(0, world.rotation[9] * Vec3<double>{0, 0, 1})));
    const Vec3<double> gaze = seen_from(9, world.rotation[15] * Vec3<double>{0, 0, 1});
    t.look_left.push_back(detail::yaw_of(gaze));
    t.look_up.push_back(std::asin(std::clamp(gaze.y, -1.0, 1.0)) / degree);
    t.hands_apart.push_back(norm(p[20] - p[21]));
    double moved = 0;
    if (f > 0) {
      for (std::size_t j = 0; j < 22; ++j) moved = std::max(moved, norm(p[j] - before[j]));
      t.step.push_back(std::hypot(p[0].x - before[0].x, p[0].z - before[0].z));
      t.joint_speed.push_back(moved * m.fps);
    }
    for (const std::size_t side : {0u, 1u}) {
      const std::size_t shoulder = 16 + side, elbow = 18 + side, wrist = 20 + side, hip = 1 + side, knee = 4 + side,
                        ankle = 7 + side, toe = 10 + side;
      ArmTrace& arm = t.arms[side];
      const Vec3<double> reach = p[wrist] - p[shoulder];
      arm.raised.push_back(std::max(reach.y, dot(reach, up) - 0.15 * std::min(1.0, t.lean.back() / 60)));
      arm.elbow.push_back(detail::angle_at(p[shoulder], p[elbow], p[wrist]));
      arm.to_mouth.push_back(norm(p[wrist] - p[15]));
      arm.hand.push_back(seen_from(9, p[wrist] - p[9]));
      arm.above_floor.push_back(p[wrist].y);
      LegTrace& leg = t.legs[side];
      leg.height.push_back(detail::foot_over_floor(
          p, {{static_cast<int>(hip), static_cast<int>(knee), static_cast<int>(ankle)}, static_cast<int>(toe)}, {}));
      leg.knee.push_back(p[knee].y);
      leg.yaw.push_back(detail::continued(detail::yaw_of(p[toe] - p[ankle]), leg.yaw));
      leg.ahead.push_back(rotate(detail::turn(-heading), p[ankle] - p[0]).z);
      if (f > 0) {
        arm.speed.push_back(m.fps * norm((p[wrist] - p[0]) - (before[wrist] - before[0])));
        leg.speed.push_back(m.fps * norm((p[ankle] - p[0]) - (before[ankle] - before[0])));
      }
    }
    before = p;
  }
  for (auto* curve : {&t.step, &t.joint_speed, &t.arms[0].speed, &t.arms[1].speed, &t.legs[0].speed, &t.legs[1].speed})
    if (!t.pelvis.empty()) curve->push_back(curve->empty() ? 0.0 : curve->back());
  if (!t.step.empty()) t.step.back() = 0;
  return t;
}

MOTIONLANG_BODY MotionTrace part_of(const MotionTrace& trace, std::size_t first, std::size_t last) {
  MotionTrace t = trace;
  const auto cut = [&](auto& curve) {
    last = std::min(last, curve.size());
    first = std::min(first, last);
    curve.erase(curve.begin() + static_cast<std::ptrdiff_t>(last), curve.end());
    curve.erase(curve.begin(), curve.begin() + static_cast<std::ptrdiff_t>(first));
  };
  for (auto* curve : {&t.over_floor, &t.pelvis, &t.head, &t.heading, &t.forward, &t.left, &t.lean, &t.twist,
                      &t.look_left, &t.look_up, &t.upside_down, &t.step, &t.joint_speed, &t.hands_apart})
    cut(*curve);
  for (ArmTrace& a : t.arms) {
    for (auto* curve : {&a.raised, &a.elbow, &a.to_mouth, &a.speed, &a.above_floor}) cut(*curve);
    cut(a.hand);
  }
  for (LegTrace& l : t.legs) {
    for (auto* curve : {&l.height, &l.knee, &l.yaw, &l.speed, &l.ahead}) cut(*curve);
  }
  return t;
}

MOTIONLANG_BODY std::vector<Flight> flights(const MotionTrace& t, double lowest) {
  std::vector<Flight> out;
  const auto& h = t.over_floor;
  for (std::size_t f = 0; f < h.size(); ++f) {
    if (h[f] <= 0.05) continue;
    Flight flight{.first = f};
    for (; f < h.size() && h[f] > 0.05; ++f) flight.peak = std::max(flight.peak, h[f]);
    flight.last = f, flight.lands = f < h.size();
    flight.seconds = static_cast<double>(f - flight.first) / t.fps;
    flight.off_arc = detail::off_arc(std::span(t.pelvis).subspan(flight.first, f - flight.first), t.fps);
    if (flight.peak >= lowest) out.push_back(flight);
  }
  return out;
}

MOTIONLANG_BODY double longest_hover(const MotionTrace& t) {
  double longest = 0;
  for (const Flight& f : flights(t)) longest = std::max(longest, f.seconds);
  return longest;
}
MOTIONLANG_BODY double sunken_seconds(const MotionTrace& t) {
  return static_cast<double>(
             std::count_if(t.over_floor.begin(), t.over_floor.end(), [](double h) { return h < -0.04; })) /
         t.fps;
}
MOTIONLANG_BODY double still_share(const MotionTrace& t) {
  return static_cast<double>(
             std::count_if(t.joint_speed.begin(), t.joint_speed.end(), [](double v) { return v < 0.15; })) /
         std::max(1.0, static_cast<double>(t.frames()));
}
MOTIONLANG_BODY double turned_on_flat_soles(const MotionTrace& t) {
  double turned = 0;
  for (std::size_t f = 0; f + 1 < t.frames(); ++f) {
    const auto &l = t.legs[0], &r = t.legs[1];
    if (std::max({l.height[f], l.height[f + 1], r.height[f], r.height[f + 1]}) > 0.03) continue;
    const double a = l.yaw[f + 1] - l.yaw[f], b = r.yaw[f + 1] - r.yaw[f];
    if (a * b > 0) turned += std::min(std::abs(a), std::abs(b));
  }
  return turned;
}

MOTIONLANG_BODY std::string look_wrong(const MotionTrace& t, const EyeLimits& limits) {
  if (const double s = longest_hover(t); s > limits.hover) return "hovers " + detail::two_digits(s) + " s";
  if (const double s = sunken_seconds(t); s > limits.sunken) return "sinks in for " + detail::two_digits(s) + " s";
  for (const Flight& f : flights(t, 0.08)) {
    if (f.off_arc > limits.off_arc) return "flies off its arc by " + detail::two_digits(f.off_arc) + " m";
  }
  if (const double d = turned_on_flat_soles(t); d > limits.flat_turn)
    return "turns " + detail::two_digits(d) + " degrees on flat soles";
  return "";
}

MOTIONLANG_BODY std::size_t rises(const std::vector<double>& curve, double low, double high) {
  std::size_t count = 0;
  bool was_low = false;
  for (const double v : curve) {
    if (v < low) was_low = true;
    if (v > high && was_low) ++count, was_low = false;
  }
  return count;
}
MOTIONLANG_BODY std::size_t reversals(const std::vector<double>& curve, double way) {
  std::size_t count = 0;
  int direction = 0;
  double extreme = curve.empty() ? 0 : curve.front();
  double low = extreme, high = extreme;
  for (const double v : curve) {
    low = std::min(low, v), high = std::max(high, v);
    if (direction == 0) {
      if (v - low >= way) direction = 1, extreme = v;
      if (high - v >= way) direction = -1, extreme = v;
    } else if (direction * (v - extreme) > 0) {
      extreme = v;
    } else if (direction * (extreme - v) >= way) {
      ++count, direction = -direction, extreme = v;
    }
  }
  return count;
}

MOTIONLANG_NAMESPACE_END
