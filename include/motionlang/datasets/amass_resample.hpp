// SPDX-License-Identifier: MIT
/// The preparation of STMC's training data from AMASS: another frame rate, and mirrored copies. This is for parity; for
/// your own clips use kinematics/motion_tools.hpp.
///
/// Source  STMC, prepare/amasstools/fix_fps.py and smpl_mirroring.py
#pragma once

#include <algorithm>  // min, max
#include <cmath>      // acos, sin
#include <span>       // inputs
#include <vector>     // results

#include <motionlang/core/concepts.hpp>
#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/kinematics/body_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// SMPL poses as AMASS files have them.
template <Scalar S>
struct AmassPoses {
  std::vector<S> poses;  // (frames, 3 joints) rotation vectors
  std::vector<S> trans;  // (frames, 3)
};

namespace detail {

/// The number of values of one pose. Throws shape_error 205 unless both arrays have the same number of frames.
template <Scalar S>
std::size_t amass_width(std::span<const S> poses, std::span<const S> trans, const char* op) {
  const std::size_t frames = trans.size() / 3;
  if (trans.size() % 3 != 0 || (frames == 0 ? !poses.empty() : poses.size() % (3 * frames) != 0)) {
    raise<shape_error>(205, op, ": ", poses.size(), " pose values for ", trans.size(), " translation values");
  }
  return frames == 0 ? 0 : poses.size() / frames;
}

/// Spherical interpolation of vectors that keep their lengths as weights:
///     (sin((1-t) h) a + sin(t h) b) / sin h,   h: the angle between a and b; linear if |cos h| > 0.9995 or one is zero
/// This is not a rotation halfway between two rotations, but the data were made with it.
template <Scalar S>
Vec3<S> slerp_of_vectors(const Vec3<S>& a, const Vec3<S>& b, S t) {
  const S lengths = norm(a) * norm(b), cosine = lengths > 0 ? dot(a, b) / lengths : S(1);
  if (std::abs(cosine) > S(0.9995)) return (S(1) - t) * a + t * b;
  const S h = std::acos(cosine), sine = std::sin(h);
  return (std::sin((S(1) - t) * h) / sine) * a + (std::sin(t * h) / sine) * b;
}

}  // namespace detail

/// floor(T new / old) frames; frame i shows the source at (i + 1/2) old / new - 1/2, but not before its first frame.
/// Coordinates are float32, as published. Translations are linear, poses a slerp of their rotation vectors. Throws
/// shape_error 205, and config_error 101 unless both rates are positive.
template <Scalar S>
AmassPoses<S> amass_resample(std::span<const S> poses, std::span<const S> trans, double old_fps, double new_fps) {
  detail::require_rates("amass_resample", old_fps, new_fps);
  const std::size_t width = detail::amass_width(poses, trans, "amass_resample"), source = trans.size() / 3;
  const auto frames = static_cast<std::size_t>(std::floor(static_cast<double>(source) * new_fps / old_fps));
  AmassPoses<S> out;
  for (std::size_t i = 0; i < frames; ++i) {
    const auto ratio = static_cast<float>(old_fps / new_fps);
    const float at = std::max((static_cast<float>(i) + 0.5f) * ratio - 0.5f, 0.0f);
    const std::size_t a = std::min(static_cast<std::size_t>(at), source - 1), b = std::min(a + 1, source - 1);
    const S t = static_cast<S>(at - static_cast<float>(a));
    for (std::size_t k = 0; k < 3; ++k) out.trans.push_back((S(1) - t) * trans[3 * a + k] + t * trans[3 * b + k]);
    for (std::size_t k = 0; k < width; k += 3) {
      const S *p = &poses[a * width + k], *q = &poses[b * width + k];
      const auto v = detail::slerp_of_vectors<S>({p[0], p[1], p[2]}, {q[0], q[1], q[2]}, t);
      out.poses.insert(out.poses.end(), {v.x, v.y, v.z});
    }
  }
  return out;
}

/// Left and right exchanged, exactly. Partners swap their rotation vectors, whose y and z change sign, and the path
/// changes the sign of x. Throws shape_error 205 unless poses have the 22 or 24 joints of SMPL.
template <Scalar S>
AmassPoses<S> amass_mirror(std::span<const S> poses, std::span<const S> trans) {
  const std::size_t width = detail::amass_width(poses, trans, "amass_mirror"), frames = trans.size() / 3;
  if (frames != 0 && width != 66 && width != 72) {
    raise<shape_error>(205, "amass_mirror: poses of ", width, " values; expected 66 or 72");
  }
  AmassPoses<S> out{{poses.begin(), poses.end()}, {trans.begin(), trans.end()}};
  for (std::size_t f = 0; f < frames; ++f) {
    out.trans[3 * f] = -trans[3 * f];
    for (std::size_t j = 0; 3 * j < width; ++j) {
      const S* from = &poses[f * width + 3 * static_cast<std::size_t>(smpl_mirror_joint[j])];
      S* to = &out.poses[f * width + 3 * j];
      to[0] = from[0], to[1] = -from[1], to[2] = -from[2];
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
