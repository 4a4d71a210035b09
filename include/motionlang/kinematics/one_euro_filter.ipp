// SPDX-License-Identifier: MIT
// Bodies of one_euro_filter.hpp.
#pragma once

#include <cmath>    // abs, isfinite
#include <numbers>  // pi
#include <vector>   // speeds

#include <motionlang/geometry/slerp.hpp>
#include <motionlang/kinematics/one_euro_filter.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The share of a new value.
inline double one_euro_share(double cutoff, double fps) { return 1 / (1 + fps / (2 * std::numbers::pi * cutoff)); }

/// The share of a value that differs this much from the smoothed one. Updates the speed.
inline double one_euro_step(double change, double& speed, double fps, const OneEuroOptions& o) {
  const double slow = one_euro_share(o.derivative_cutoff, fps);
  speed = slow * change * fps + (1 - slow) * speed;
  return one_euro_share(o.min_cutoff + o.beta * std::abs(speed), fps);
}

inline void require_one_euro(double fps, const OneEuroOptions& o) {
  const bool finite =
      std::isfinite(fps) && std::isfinite(o.min_cutoff) && std::isfinite(o.beta) && std::isfinite(o.derivative_cutoff);
  if (!finite || !(fps > 0 && o.min_cutoff > 0 && o.derivative_cutoff > 0 && o.beta >= 0))
    raise<config_error>(101, "OneEuroFilter: ", fps, " frames per second, min_cutoff ", o.min_cutoff, ", beta ", o.beta,
                        ", derivative_cutoff ", o.derivative_cutoff);
}

}  // namespace detail

MOTIONLANG_BODY OneEuroFilter::OneEuroFilter(double fps, const OneEuroOptions& options) : options_(options), fps_(fps) {
  detail::require_one_euro(fps, options);
}

MOTIONLANG_BODY double OneEuroFilter::operator()(double x) {
  if (!last_) return *(last_ = x);
  const double share = detail::one_euro_step(x - *last_, speed_, fps_, options_);
  return *(last_ = share * x + (1 - share) * *last_);
}

MOTIONLANG_BODY Motion one_euro_filter(const Motion& motion, const OneEuroOptions& options) {
  detail::require_one_euro(motion.fps, options);
  Motion out = motion;
  OneEuroFilter x(motion.fps, options), y = x, z = x;
  for (Vec3<double>& p : out.root) p = {x(p.x), y(p.y), z(p.z)};
  std::vector<double> speeds(static_cast<std::size_t>(motion.skeleton.size()));
  for (Index f = 1; f < motion.frames(); ++f) {
    const auto before = out.rotations(f - 1), now = out.rotations(f);
    for (std::size_t j = 0; j < now.size(); ++j) {
      const double share = detail::one_euro_step(distance(before[j], now[j]), speeds[j], motion.fps, options);
      now[j] = slerp(before[j], now[j], share);
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
