// SPDX-License-Identifier: MIT
/// Rotation invariant forward kinematic encoding of joint positions ("rifke"), and its inverse: TEMOS' 64 values for
/// the 21 joints of MMM, and SINC's 67 and TMR's 67 or 73 for SMPL's joints.
///
///     0             height of the root above the floor
///    1:3J-2        joints 1 ... J-1 seen from the body: x', then y and z of the world, one of them turned
///     3J-2          turn of the heading, radians per frame
///     3J-1:3J+1     velocity of the root over the ground, seen from the body, per frame
/// World: Y up with x, z level (TEMOS, any unit), or Z up with x, y level (SINC, TMR).
///
/// Source  Holden et al., "A deep learning framework for character motion synthesis and editing" (SIGGRAPH 2016); TEMOS
///         (ECCV 2022), appendix B.1, temos/transforms/joints2jfeats/rifke.py; SINC
///         sinc/transforms/joints2jfeats/rifke.py; TMR src/rifke.py
#pragma once

#include <algorithm>    // min, max, copy_n
#include <array>        // pairs of joints
#include <cmath>        // log, atan2
#include <limits>       // infinity
#include <span>         // joints
#include <string_view>  // who complains
#include <vector>       // features

#include <motionlang/features/smplrifke.hpp>
#include <motionlang/kinematics/gaussian_smooth.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One of the published variants, or one of your own.
struct RifkeVariant {
  Index joints = 0;
  bool z_up = false;
  std::array<std::array<int, 2>, 2> across{};  // pairs (right, left) whose difference points across the body
  std::vector<int> floor{};                    // the lowest of these is on the floor; none: height 0
  bool wrapped_turns = true;                   // turns in (-pi, pi]; false: they jump if the heading passes pi
  bool swapped_forward = false;      // sine and cosine are (-x, y) of the vector across; false: (-y, x), straight ahead
  bool forward_differences = false;  // turns and velocities to the next frame; false: from the one before
  Index size() const { return 3 * joints + 1; }
};

/// TEMOS and TEACH's metrics. The heading is that of knees and elbows, as published (an index is off by one).
inline RifkeVariant temos_rifke() {
  return {.joints = 21, .across = {{{17, 12}, {9, 6}}}, .floor = {14, 15, 19, 20}, .wrapped_turns = false};
}
/// SINC's metrics, whose heading is swapped as published.
inline RifkeVariant sinc_rifke() {
  return {.joints = 22, .z_up = true, .across = {{{2, 1}, {17, 16}}}, .floor = {7, 10, 8, 11}, .swapped_forward = true};
}
/// TMR's canonical view; 22 or 24 joints of SMPL.
inline RifkeVariant tmr_rifke(Index joints = 22) {
  return {.joints = joints, .z_up = true, .across = {{{2, 1}, {17, 16}}}, .forward_differences = true};
}

template <Scalar S>
struct RifkeFeatures {
  std::vector<S> features;                // (frames, 3 J + 1)
  S floor{};                              // height of the floor
  std::vector<std::array<S, 2>> forward;  // (frames): sine and cosine of the heading
  std::vector<S> angles;                  // (frames): the heading
};

namespace detail {

/// Level coordinates and height of a vector.
template <Scalar S>
struct LevelVector {
  S a{}, b{}, height{};
};
template <Scalar S>
LevelVector<S> leveled(const Vec3<S>& v, bool z_up) {
  return z_up ? LevelVector<S>{v.x, v.y, v.z} : LevelVector<S>{v.x, v.z, v.y};
}
template <Scalar S>
Vec3<S> unleveled(const LevelVector<S>& v, bool z_up) {
  return z_up ? Vec3<S>{v.a, v.b, v.height} : Vec3<S>{v.a, v.height, v.b};
}
/// Into the body's view: a' = a cos - b sin, b' = a sin + b cos. With -sine: back.
template <Scalar S>
LevelVector<S> turned(const LevelVector<S>& v, S sine, S cosine) {
  return {v.a * cosine - v.b * sine, v.a * sine + v.b * cosine, v.height};
}
inline std::size_t rifke_frames(std::string_view function, std::size_t values, Index per_frame) {
  if (per_frame < 2 || static_cast<Index>(values) % per_frame != 0) {
    raise<shape_error>(205, function, ": ", values, " values are not frames of ", per_frame);
  }
  return values / static_cast<std::size_t>(per_frame);
}
/// Throws shape_error 203 if the variant names a joint that it does not have.
inline void require_joints(const RifkeVariant& variant) {
  auto require = [&](int joint) {
    if (joint < 0 || joint >= variant.joints) raise<shape_error>(203, "rifke: joint ", joint, " of ", variant.joints);
  };
  for (const auto& [right, left] : variant.across) require(right), require(left);
  for (const int joint : variant.floor) require(joint);
}
/// Smoothing with sigma 2 and zeros beyond the ends.
template <Scalar S>
void filter_forward(std::vector<std::array<S, 2>>& forward) {
  constexpr std::size_t radius = 8;
  std::vector<S> padded((forward.size() + 2 * radius) * 2);
  for (std::size_t t = 0; t < forward.size(); ++t) std::copy_n(forward[t].begin(), 2, &padded[2 * (t + radius)]);
  const auto smooth = gaussian_smooth(std::span<const S>(padded), 2, 2);
  for (std::size_t t = 0; t < forward.size(); ++t) {
    const Vec3<S> f = normalized(Vec3<S>{smooth[2 * (t + radius)], smooth[2 * (t + radius) + 1], S(0)});
    forward[t] = {f.x, f.y};
  }
}

}  // namespace detail

/// joints          (frames, J)
/// forward_filter  smooths the heading, as an option of TEMOS does
/// The floor is soft: m - ln(1/2 + exp(m - M)) for the lowest (m) and highest (M) height of the lowest joint.
/// Throws          shape_error 205, 203 if the variant names a joint that it does not have
template <Scalar S>
RifkeFeatures<S> rifke_features(const RifkeVariant& variant, std::span<const Vec3<S>> joints,
                                bool forward_filter = false) {
  const std::size_t frames = detail::rifke_frames("rifke_features", joints.size(), variant.joints);
  detail::require_joints(variant);
  const auto n = static_cast<std::size_t>(variant.joints);
  auto at = [&](std::size_t t, std::size_t j) { return detail::leveled(joints[t * n + j], variant.z_up); };
  RifkeFeatures<S> out;
  if (!variant.floor.empty() && frames > 0) {
    S lowest = std::numeric_limits<S>::infinity(), highest = -lowest;
    for (std::size_t t = 0; t < frames; ++t) {
      S height = std::numeric_limits<S>::infinity();
      for (const int j : variant.floor) height = std::min(height, at(t, static_cast<std::size_t>(j)).height);
      lowest = std::min(lowest, height), highest = std::max(highest, height);
    }
    out.floor = lowest - std::log(S(0.5) + std::exp(lowest - highest));
  }
  for (std::size_t t = 0; t < frames; ++t) {
    S a{}, b{};
    for (const auto& [right, left] : variant.across) {
      const auto r = at(t, static_cast<std::size_t>(right)), l = at(t, static_cast<std::size_t>(left));
      a += r.a - l.a, b += r.b - l.b;
    }
    const Vec3<S> f = normalized(variant.swapped_forward ? Vec3<S>{-a, b, S(0)} : Vec3<S>{-b, a, S(0)});
    out.forward.push_back({f.x, f.y});
  }
  if (forward_filter) detail::filter_forward(out.forward);
  for (const auto& [sine, cosine] : out.forward) out.angles.push_back(std::atan2(sine, cosine));

  auto turn = [&](std::size_t t) {
    const S d = out.angles[t + 1] - out.angles[t];
    return variant.wrapped_turns ? detail::wrapped(d) : d;
  };
  auto way = [&](std::size_t t) { return joints[(t + 1) * n] - joints[t * n]; };
  std::vector<S> turns(frames);
  std::vector<Vec3<S>> ways(frames);
  if (variant.forward_differences) {
    turns = detail::to_next<S>(frames, turn);
    ways = detail::to_next<Vec3<S>>(frames, way);
    if (variant.wrapped_turns && frames > 0) turns.back() = detail::wrapped(turns.back());
  } else {
    for (std::size_t t = 0; t + 1 < frames; ++t) turns[t + 1] = turn(t), ways[t + 1] = way(t);
  }
  out.features.reserve(frames * static_cast<std::size_t>(variant.size()));
  for (std::size_t t = 0; t < frames; ++t) {
    const auto [sine, cosine] = out.forward[t];
    const auto root = at(t, 0);
    out.features.push_back(root.height - out.floor);
    for (std::size_t j = 1; j < n; ++j) {
      const auto p = at(t, j);
      const detail::LevelVector<S> own{p.a - root.a, p.b - root.b, p.height - out.floor};
      const auto v = detail::unleveled(detail::turned(own, sine, cosine), variant.z_up);
      out.features.insert(out.features.end(), {v.x, v.y, v.z});
    }
    const auto v = detail::turned(detail::leveled(ways[t], variant.z_up), sine, cosine);
    out.features.insert(out.features.end(), {turns[t], v.a, v.b});
  }
  return out;
}

/// features  (frames, 3 J + 1), not normalised
/// result    (frames, J); frame 0 is at the origin with heading 0, on the floor
/// Throws    shape_error 205
template <Scalar S>
std::vector<Vec3<S>> rifke_joints(const RifkeVariant& variant, std::span<const S> features) {
  const std::size_t frames = detail::rifke_frames("rifke_joints", features.size(), variant.size());
  const auto width = static_cast<std::size_t>(variant.size());
  std::vector<Vec3<S>> out;
  S angle{};
  detail::LevelVector<S> root{};
  for (std::size_t t = 0; t < frames; ++t) {
    const auto row = features.subspan(t * width, width);
    const S turn = row[width - 3];
    const detail::LevelVector<S> velocity{row[width - 2], row[width - 1], S(0)};
    auto step = [&] {
      const auto way = detail::turned(velocity, -std::sin(angle), std::cos(angle));
      root.a += way.a, root.b += way.b;
    };
    if (!variant.forward_differences && t > 0) angle += turn, step();
    root.height = row[0];
    out.push_back(detail::unleveled(root, variant.z_up));
    for (std::size_t at = 1; at + 3 < width; at += 3) {
      const auto own = detail::leveled(Vec3<S>{row[at], row[at + 1], row[at + 2]}, variant.z_up);
      const auto p = detail::turned(own, -std::sin(angle), std::cos(angle));
      out.push_back(detail::unleveled<S>({p.a + root.a, p.b + root.b, p.height}, variant.z_up));
    }
    if (variant.forward_differences) step(), angle += turn;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
