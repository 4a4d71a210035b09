// SPDX-License-Identifier: MIT
// Bodies of floor_fix.hpp.
#pragma once

#include <algorithm>  // clamp, max, min, nth_element

#include <motionlang/kinematics/floor_fix.hpp>
#include <motionlang/kinematics/gaussian_smooth.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The joints of one frame among (frames, joints).
inline std::span<const Vec3<double>> pose_of(std::span<const Vec3<double>> positions, Index joints, Index frame) {
  return positions.subspan(static_cast<std::size_t>(frame * joints), static_cast<std::size_t>(joints));
}

/// 0 up to the tolerance, x from twice the tolerance on, and linear between.
inline double beyond(double x, double tolerance) { return x >= 2 * tolerance ? x : std::max(0.0, 2 * (x - tolerance)); }

/// The smallest (of larger: largest) value within `reach` frames of each.
inline std::vector<double> extremes(std::span<const double> values, Index reach, bool larger) {
  const Index n = std::ssize(values);
  std::vector<double> out;
  for (Index f = 0; f < n; ++f) {
    double best = values[static_cast<std::size_t>(f)];
    for (Index k = std::max<Index>(0, f - reach); k <= std::min(n - 1, f + reach); ++k) {
      const double v = values[static_cast<std::size_t>(k)];
      best = larger ? std::max(best, v) : std::min(best, v);
    }
    out.push_back(best);
  }
  return out;
}

/// The height of each frame of a flight above the arc of a thrown body with the same peak. The peak is in the middle of
/// the frames that are nearly as high.
/// heights  above the floor, without hovering
inline std::vector<double> above_arcs(std::span<const double> heights, double fps, const FloorFixOptions& options) {
  const Index n = std::ssize(heights);
  std::vector<double> above(heights.size(), 0.0);
  const auto h = [&](Index f) { return heights[static_cast<std::size_t>(f)]; };
  for (Index first = 0, last = 0; first < n; first = last + 1) {
    for (last = first; last < n && h(last) > options.tolerance; ++last) {}
    if (first == last) continue;
    double peak = 0;
    for (Index f = first; f < last; ++f) peak = std::max(peak, h(f));
    Index from = last, to = first;
    for (Index f = first; f < last; ++f) {
      if (h(f) >= 0.9 * peak) from = std::min(from, f), to = std::max(to, f);
    }
    const double middle = 0.5 * static_cast<double>(from + to);
    for (Index f = first; f < last; ++f) {
      const double t = (static_cast<double>(f) - middle) / fps;
      above[static_cast<std::size_t>(f)] = h(f) - std::clamp(peak - 0.5 * options.gravity * t * t, 0.0, h(f));
    }
  }
  return above;
}

/// A smooth curve that is never below the values.
inline std::vector<double> smooth_above(std::span<const double> values, double sigma) {
  const auto wide = extremes(values, 1, true);
  return gaussian_smooth(std::span<const double>(wide), 1, sigma);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<double> heights_over_floor(const Motion& motion, std::span<const Leg> legs,
                                                       const FloorFixOptions& options) {
  detail::require_legs("heights_over_floor", motion.skeleton, legs);
  const auto positions = motion.positions();
  const Index joints = motion.skeleton.size();
  std::vector<bool> of_foot(static_cast<std::size_t>(joints));
  for (const Leg& leg : legs) {
    for (const int joint : {leg.limb.end, leg.toe}) of_foot[static_cast<std::size_t>(joint)] = true;
  }
  std::vector<double> heights;
  for (Index f = 0; f < motion.frames(); ++f) {
    const auto pose = detail::pose_of(positions, joints, f);
    double trunk = pose.front().y - options.floor - options.body_rests;
    for (std::size_t j = 0; j < pose.size(); ++j) {
      if (!of_foot[j]) trunk = std::min(trunk, pose[j].y - options.floor - options.body_rests);
    }
    double lowest = trunk;
    for (const Leg& leg : legs) lowest = std::min(lowest, detail::foot_over_floor(pose, leg, options));
    const double standing =
        options.seated > 0 ? std::clamp((pose.front().y - options.floor - options.seated) / 0.2, 0.0, 1.0) : 1;
    heights.push_back(trunk + standing * (lowest - trunk));
  }
  return heights;
}

MOTIONLANG_BODY Motion stand_on_floor(const Motion& motion, std::span<const Leg> legs, const FloorFixOptions& options) {
  if (!(options.longest_flight > 0 && options.sigma > 0))
    raise<config_error>(101, "stand_on_floor: flights of ", options.longest_flight, " s, sigma ", options.sigma, " s");
  const auto heights = heights_over_floor(motion, legs, options);
  if (heights.empty()) return motion;
  const double sigma = options.sigma * motion.fps;  // frames
  const auto reach = static_cast<Index>(
      std::min(0.5 * options.longest_flight * motion.fps + 0.5, static_cast<double>(motion.frames())));
  const auto hovering = detail::extremes(detail::extremes(heights, reach, false), reach, true);
  std::vector<double> down, up, left;
  for (std::size_t f = 0; f < heights.size(); ++f) down.push_back(detail::beyond(hovering[f], options.tolerance));
  down = gaussian_smooth(std::span<const double>(down), 1, 2 * sigma);
  for (std::size_t f = 0; f < heights.size(); ++f) {
    left.push_back(heights[f] - down[f]);
    up.push_back(detail::beyond(-left[f], options.tolerance));
  }
  auto arcs = detail::above_arcs(left, motion.fps, options);
  for (double& a : arcs) a = detail::beyond(a, options.tolerance);
  arcs = gaussian_smooth(std::span<const double>(arcs), 1, sigma);
  up = detail::smooth_above(up, 2 * sigma);
  Motion out = motion;
  for (std::size_t f = 0; f < heights.size(); ++f) out.root[f].y += up[f] - down[f] - arcs[f];
  return out;
}

MOTIONLANG_BODY Motion lift_sunken_feet(const Motion& motion, std::span<const Leg> legs,
                                        const FloorFixOptions& options) {
  detail::require_legs("lift_sunken_feet", motion.skeleton, legs);
  if (motion.frames() == 0) return motion;
  const auto positions = motion.positions();
  Motion out = motion;
  for (const Leg& leg : legs) {
    std::vector<double> sunk;
    for (Index f = 0; f < motion.frames(); ++f)
      sunk.push_back(
          detail::beyond(-detail::foot_over_floor(detail::pose_of(positions, motion.skeleton.size(), f), leg, options),
                         options.foot_sinks));
    std::vector<Vec3<double>> lift;
    for (const double y : detail::smooth_above(sunk, options.sigma * motion.fps)) lift.push_back({0, y, 0});
    detail::move_foot(out, leg, lift);
  }
  return out;
}

MOTIONLANG_BODY Motion ground_recording(const Motion& motion, bool seated, std::span<const Leg> legs,
                                        FloorFixOptions options) {
  if (seated) options.seated = 0.6, options.longest_flight = 0.1;
  auto heights = heights_over_floor(motion, legs, options);
  if (heights.empty()) return motion;
  const auto tenth = heights.begin() + std::ssize(heights) / 10;
  std::nth_element(heights.begin(), tenth, heights.end());
  Motion out = motion;
  for (Vec3<double>& root : out.root) root.y -= *tenth;
  return fix_floor(out, legs, options);
}

MOTIONLANG_NAMESPACE_END
