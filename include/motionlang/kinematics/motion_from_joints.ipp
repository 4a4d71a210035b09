// SPDX-License-Identifier: MIT
// Bodies of motion_from_joints.hpp.
#pragma once

#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/motion_from_joints.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Quaternion<double> fit_rotation(std::span<const SeenVector> vectors, Quaternion<double> start) {
  constexpr int most_steps = 200;
  if (vectors.size() == 1 && norm(vectors[0].rest) > 0 && norm(vectors[0].seen) > 0)
    return rotation_between(rotate(start, vectors[0].rest), vectors[0].seen) * start;
  for (int step = 0; step < most_steps; ++step) {
    Vec3<double> turn{};
    double along = 0;
    for (const SeenVector& v : vectors) {
      const Vec3<double> a = rotate(start, v.rest);
      turn = turn + cross(a, v.seen);
      along += dot(a, v.seen);
    }
    const double size = norm(turn);
    if (!(size > 1e-12 * std::abs(along)) || size < 1e-300) break;
    const double angle = std::min(size / std::max(std::abs(along), 1e-300), 1.0);
    start = normalized(from_axis_angle((1 / size) * turn, angle) * start);
  }
  return start;
}

namespace detail {

inline double misfit(std::span<const SeenVector> vectors, const Quaternion<double>& q) {
  double sum = 0;
  for (const SeenVector& v : vectors) {
    const Vec3<double> d = rotate(q, v.rest) - v.seen;
    sum += dot(d, d);
  }
  return sum;
}

/// The bones that begin at one joint, in the mean arrangement of the clip, turned as at rest. They keep their lengths.
/// Each round turns the bones of every frame onto those at rest and takes the means.
/// rest   (bones); seen (frames, bones)
inline std::vector<Vec3<double>> bones_of_one_joint(std::vector<Vec3<double>> rest,
                                                    std::span<const Vec3<double>> seen) {
  constexpr int rounds = 10;
  constexpr std::size_t most_frames = 200;
  const std::size_t n = rest.size(), frames = seen.size() / n, step = std::max<std::size_t>(1, frames / most_frames);
  std::vector<Vec3<double>> at_rest = rest;
  auto turn = Quaternion<double>::identity();
  std::vector<SeenVector> pairs(n);
  for (int round = 0; round < rounds; ++round) {
    std::vector<Vec3<double>> sum(n);
    for (std::size_t f = 0; f < frames; f += step) {
      for (std::size_t k = 0; k < n; ++k) pairs[k] = {rest[k], seen[f * n + k]};
      turn = fit_rotation(pairs, turn);
      for (std::size_t k = 0; k < n; ++k) sum[k] = sum[k] + rotate(inverse(turn), seen[f * n + k]);
    }
    for (std::size_t k = 0; k < n; ++k) {
      if (!(norm(sum[k]) > 0)) return at_rest;
      pairs[k] = {(norm(at_rest[k]) / norm(sum[k])) * sum[k], at_rest[k]};
    }
    const Quaternion<double> back = fit_rotation(pairs, Quaternion<double>::identity());
    for (std::size_t k = 0; k < n; ++k) rest[k] = rotate(back, pairs[k].rest);
  }
  return rest;
}

}  // namespace detail

MOTIONLANG_BODY Motion motion_from_joints(const Skeleton& skeleton, std::span<const Vec3<double>> joints, Index count,
                                          double fps) {
  if (count < 1 || count > skeleton.size())
    raise<config_error>(101, "motion_from_joints: ", count, " joints for a skeleton of ", skeleton.size());
  const auto n = static_cast<std::size_t>(count), frames = joints.size() / n;
  if (joints.size() != frames * n)
    raise<shape_error>(205, "motion_from_joints: ", joints.size(), " positions are not frames of ", count, " joints");
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!std::isfinite(joints[i].x + joints[i].y + joints[i].z))
      raise<numeric_error>(301, "motion_from_joints: joint ", i % n, " in frame ", i / n, " is not finite");
  }
  Motion out{skeleton, fps, {}, {}, {}};
  std::vector<std::vector<std::size_t>> children(n);
  for (std::size_t j = 1; j < n; ++j) {
    const auto parent = static_cast<std::size_t>(skeleton.parents[j]);
    children[parent].push_back(j);
    double length = 0;
    for (std::size_t f = 0; f < frames; ++f) length += norm(joints[f * n + j] - joints[f * n + parent]);
    const double rest = norm(skeleton.offsets[j]);
    if (rest > 0 && frames > 0)
      out.skeleton.offsets[j] = (length / static_cast<double>(frames) / rest) * skeleton.offsets[j];
  }
  for (std::size_t j = 0; j < n; ++j) {
    if (children[j].size() < 2 || frames == 0) continue;
    std::vector<Vec3<double>> rest, seen;
    for (const std::size_t c : children[j]) rest.push_back(out.skeleton.offsets[c]);
    for (std::size_t f = 0; f < frames; ++f) {
      for (const std::size_t c : children[j]) seen.push_back(joints[f * n + c] - joints[f * n + j]);
    }
    rest = detail::bones_of_one_joint(std::move(rest), seen);
    for (std::size_t k = 0; k < rest.size(); ++k) out.skeleton.offsets[children[j][k]] = rest[k];
  }
  const auto all = static_cast<std::size_t>(skeleton.size());
  std::vector<Quaternion<double>> world(all);
  for (std::size_t f = 0; f < frames; ++f) {
    const auto frame = joints.subspan(f * n, n);
    out.root.push_back(frame[0]);
    for (std::size_t j = 0; j < all; ++j) {
      const int parent = skeleton.parents[j];
      const auto up = parent < 0 ? Quaternion<double>::identity() : world[static_cast<std::size_t>(parent)];
      std::vector<SeenVector> bones;
      if (j < n) {
        for (const std::size_t c : children[j]) bones.push_back({out.skeleton.offsets[c], frame[c] - frame[j]});
      }
      world[j] = fit_rotation(bones, up);
      for (int quarter = 1; parent < 0 && quarter < 4; ++quarter) {  // for any heading
        const auto start = from_axis_angle(Vec3<double>{0, 1, 0}, quarter * std::numbers::pi / 2);
        const auto other = fit_rotation(bones, start);
        if (detail::misfit(bones, other) < detail::misfit(bones, world[j]) - 1e-12) world[j] = other;
      }
      out.local.push_back(inverse(up) * world[j]);
    }
  }
  out.validate();
  return out;
}

MOTIONLANG_NAMESPACE_END
