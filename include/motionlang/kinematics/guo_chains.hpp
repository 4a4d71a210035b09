// SPDX-License-Identifier: MIT
/// A body as chains of joints with one zero direction for every bone, for HumanML3D and KIT.
///
/// Source  Guo et al., "Generating diverse and natural 3D human motions from text" (CVPR 2022), HumanML3D
///         paramUtil.py
/// World   Y up, a body faces +Z with its left side at +X (KIT's coordinates are mirrored, see below)
#pragma once

#include <array>   // pairs of joints
#include <string>  // name
#include <vector>  // chains

#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The bone that ends at `joint`. `before` is the joint whose rotation precedes it: the joint before in its chain. For
/// the first bone of a chain it is the root, even if the chain branches off elsewhere.
struct ChainBone {
  std::size_t joint = 0, parent = 0, before = 0;
};

/// Chains are processed in order. Each begins at the root (joint 0) or at a joint of an earlier chain.
struct ChainSkeleton {
  std::string name;
  std::vector<std::vector<int>> chains;
  std::vector<Vec3<double>> directions;  // unit vector of the bone that ends at each joint; nothing for the root
  std::array<int, 4> face{};             // right hip, left hip, right shoulder, left shoulder: for the heading
  std::array<int, 2> leg{};              // joints at which thigh and shank end: for the height
  std::array<int, 2> left_foot{}, right_foot{};  // ankle and toes: for contacts with the floor
  double foot_threshold = 0;                     // a foot stands if its squared displacement per frame is smaller
  double fps = 20;
  std::vector<double> lengths{};  // of the bones of the reference skeleton; empty if not published

  std::size_t size() const { return directions.size(); }

  /// All bones in the order of the chains, parents first. Throws config_error 106 unless every joint except the root
  /// ends one bone, chains begin at earlier joints, and all joints and directions exist.
  std::vector<ChainBone> bones() const;
  /// Throws as bones().
  void validate() const { bones(); }
  /// Parent of each joint, -1 for the root.
  std::vector<int> parents() const;
};

/// HumanML3D: the first 22 joints of SMPL, metres, 20 frames per second. Lengths: first frame of its clip 000021.
const ChainSkeleton& humanml3d_chains();

/// KIT Motion-Language: 21 joints of the Master Motor Map, about 640 units per metre, 12.5 frames per second. The names
/// of the data set are mirrored: joints 11 ... 15 and 5 ... 7 ("L") are the right side of the body, and this follows
/// the joints. The threshold is published in metres although the data are not, so contacts are rare. The lengths of the
/// reference clip 03950 are not published.
const ChainSkeleton& kit_chains();

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/guo_chains.ipp>
#endif
