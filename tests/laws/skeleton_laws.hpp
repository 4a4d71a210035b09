// SPDX-License-Identifier: MIT
/// Laws of skeletons and of forward kinematics, and of feature layouts:
///
///     order         parent(0) = -1 and 0 <= parent(j) < j; names are unique and find themselves
///     rest          forward kinematics of the rest pose gives the rest positions
///     bones         |p_j - p_parent(j)| = |offset_j| in every pose
///     frame         turning and moving the root turns and moves every joint: p'_j = Q p_j + t
///     branches      turning joint j moves no joint outside the branch below j
///     partition     every number of a layout belongs to exactly one body part; indices list the ranges in order
#pragma once

#include <doctest/doctest.h>

#include <motionlang/core/rng.hpp>
#include <motionlang/features/layout.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/forward.hpp>

namespace laws {

namespace ml = motionlang;

template <ml::Scalar S>
ml::Pose<S> random_pose(const ml::Skeleton& skeleton, std::uint64_t seed) {
  std::vector<S> v(3 * static_cast<std::size_t>(skeleton.size()));
  ml::Philox{.seed = seed}.normal(std::span<S>(v));
  auto pose = ml::Pose<S>::rest(skeleton);
  for (std::size_t j = 0; j < pose.local.size(); ++j)
    pose.local[j] = ml::to_quaternion(ml::AxisAngle<S>{{v[3 * j], v[3 * j + 1], v[3 * j + 2]}});
  return pose;
}

template <ml::Scalar S>
void skeleton_laws(const ml::Skeleton& skeleton) {
  const double tolerance = sizeof(S) == 4 ? 5e-6 : 1e-14;
  const auto apart = [](const ml::Vec3<S>& a, const ml::Vec3<S>& b) { return double(ml::norm(a - b)); };
  for (int j = 0; j < skeleton.size(); ++j) {
    CHECK((j == 0 ? skeleton.parent(j) == -1 : skeleton.parent(j) >= 0 && skeleton.parent(j) < j));
    CHECK(skeleton[skeleton.name(j)] == j);
  }

  const auto rest = ml::forward_kinematics(skeleton, ml::Pose<S>::rest(skeleton));
  const auto rest_positions = skeleton.rest_positions();
  const auto pose = random_pose<S>(skeleton, 1);
  const auto world = ml::forward_kinematics(skeleton, pose);
  auto moved = pose;
  const auto turn = ml::to_quaternion(ml::AxisAngle<S>{{S(0.3), S(-0.9), S(0.4)}});
  const ml::Vec3<S> shift{S(1), S(-2), S(0.5)};
  moved.local[0] = turn * pose.local[0];
  moved.root = ml::rotate(turn, pose.root) + shift;
  const auto elsewhere = ml::forward_kinematics(skeleton, moved);
  for (std::size_t j = 0; j < rest.position.size(); ++j) {
    CHECK(apart(rest.position[j], ml::vec_cast<S>(rest_positions[j])) < tolerance);
    CHECK(apart(elsewhere.position[j], ml::rotate(turn, world.position[j]) + shift) < tolerance);
    if (j == 0) continue;
    const auto p = static_cast<std::size_t>(skeleton.parents[j]);
    CHECK(std::abs(apart(world.position[j], world.position[p]) - ml::norm(skeleton.offsets[j])) < tolerance);
  }

  for (std::size_t turned = 1; turned < rest.position.size(); ++turned) {
    auto other = pose;
    other.local[turned] = turn * pose.local[turned];
    const auto after = ml::forward_kinematics(skeleton, other);
    for (std::size_t j = 0; j < rest.position.size(); ++j) {
      bool below = false;
      for (int k = skeleton.parents[j]; k >= 0; k = skeleton.parent(k)) below = below || k == static_cast<int>(turned);
      if (!below) CHECK(after.position[j] == world.position[j]);
    }
  }
}

inline void layout_laws(const ml::FeatureLayout& layout) {
  layout.validate();
  std::vector<int> owners(static_cast<std::size_t>(layout.size));
  for (int p = 0; p < layout.body.size(); ++p) {
    const auto part = static_cast<ml::BodyPart>(p);
    ml::Index last = -1, count = 0;
    for (ml::Index i : layout.indices(part)) {
      CHECK(i > last);
      last = i;
      ++owners[static_cast<std::size_t>(i)];
    }
    for (const ml::IndexRange& r : layout.ranges(part)) count += r.size();
    CHECK(count == std::ssize(layout.indices(part)));
  }
  for (int n : owners) CHECK(n == 1);
}

}  // namespace laws
