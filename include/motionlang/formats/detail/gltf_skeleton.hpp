// SPDX-License-Identifier: MIT
/// The skeleton in a glTF document: which nodes are joints, which of them is the root, and where they stand at rest.
#pragma once

#include <limits>         // no place
#include <span>           // animations
#include <string>         // names
#include <unordered_map>  // names that occur twice
#include <unordered_set>  // names
#include <vector>         // joints

#include <motionlang/formats/detail/gltf_animation.hpp>
#include <motionlang/kinematics/skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Which nodes become joints, and how they stand at rest.
class GltfSkeleton {
 public:
  Skeleton skeleton;
  std::vector<int> nodes;                          // of each joint; -1 for a root that is made up
  std::vector<Quaternion<double>> rest_rotations;  // of each joint in the world

  GltfSkeleton(const GltfDocument& document, std::span<const GltfAnimation> animations, Index skin);

 private:
  static constexpr std::size_t max_joints = 4096;
  static constexpr int nowhere = std::numeric_limits<int>::max();

  static std::size_t slot(int node) { return static_cast<std::size_t>(node); }

  /// below_ counts the joints in the subtree of every node, weighted_ tells whether they move a vertex.
  void mark_joints(const GltfDocument& document, std::span<const GltfAnimation> animations, Index skin);

  void mark_weighted(const GltfDocument& document, const std::vector<int>& joints, Index skin);

  /// The lowest node that has all joints below it, or -1 if there is none.
  int common_root(const GltfDocument& document) const;

  /// Game rigs put the hips below a root on the floor and move both. The library moves only the root of a skeleton, so
  /// that becomes the hips: the only child of `root` whose joints move vertices, if an animation moves it. -1 if not.
  int moving_hips(const GltfDocument& document, int root, std::span<const GltfAnimation> animations) const;

  /// The skeleton from `root` down: parents before children, else in the order of the skin.
  void build(const GltfDocument& document, int root);

  void add_joint(int node, int parent, const std::string& name, const Vec3<double>& offset,
                 const Quaternion<double>& q);

  std::vector<int> below_;
  std::vector<bool> weighted_;
  std::vector<int> place_;  // in the skin; of other nodes, that of the first joint below
  int total_ = 0;
  std::unordered_map<std::string, int> copies_;  // how often a name was made unique
  std::unordered_set<std::string> taken_;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/detail/gltf_skeleton.ipp>
#endif
