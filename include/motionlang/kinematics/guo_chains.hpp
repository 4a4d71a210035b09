// SPDX-License-Identifier: MIT
/// A body as chains of joints with one zero direction for every bone: what HumanML3D and KIT need to know of a
/// skeleton.
///
/// Source  Guo et al., "Generating diverse and natural 3D human motions from text" (CVPR 2022), paramUtil.py;
///         spec humanml3d-features.md 1
/// World   Y up, a body faces +Z with its left side at +X (KIT's coordinates are mirrored, see below)
#pragma once

#include <array>   // pairs of joints
#include <cmath>   // abs
#include <string>  // name
#include <vector>  // chains

#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The bone that ends at `joint`. `before` is the joint whose rotation goes ahead of it: the one before in its chain,
/// but the root for the first bone of a chain, also where the chain branches off elsewhere.
struct ChainBone {
  std::size_t joint = 0, parent = 0, before = 0;
};

/// Chains are walked one after the other; each begins at the root (joint 0) or at a joint of an earlier chain.
struct ChainSkeleton {
  std::string name;
  std::vector<std::vector<int>> chains;
  std::vector<Vec3<double>> directions;  // unit vector of the bone that ends at each joint; nothing for the root
  std::array<int, 4> face{};             // right hip, left hip, right shoulder, left shoulder: where it looks
  std::array<int, 2> leg{};              // joints at which thigh and shank end: how tall it is
  std::array<int, 2> left_foot{}, right_foot{};  // ankle and toes: where it touches the floor
  double foot_threshold = 0;                     // a foot stands if its squared displacement per frame is smaller
  double fps = 20;
  std::vector<double> lengths{};  // of the bones of the reference skeleton; empty if not published

  std::size_t size() const { return directions.size(); }

  /// All bones in the order of the chains, parents first. Throws config_error 106 unless every joint but the root ends
  /// one bone, chains begin where earlier ones have been, and all joints and directions are there.
  std::vector<ChainBone> bones() const {
    std::vector<ChainBone> out;
    std::vector<bool> placed(size(), false);
    auto known = [&](int joint) { return joint >= 0 && static_cast<std::size_t>(joint) < size(); };
    if (size() == 0) raise<config_error>(106, "ChainSkeleton '", name, "': no joints");
    placed[0] = true;
    for (std::size_t c = 0; c < chains.size(); ++c) {
      for (std::size_t k = 0; k < chains[c].size(); ++k) {
        const int joint = chains[c][k];
        const bool expected = k == 0;
        if (!known(joint) || placed[static_cast<std::size_t>(joint)] != expected) {
          raise<config_error>(106, "ChainSkeleton '", name, "': joint ", joint, " of chain ", c,
                              !known(joint) ? " does not exist"
                              : expected    ? " begins it, but no chain before contains it"
                                            : " has a bone already");
        }
        if (k == 0) continue;
        const auto j = static_cast<std::size_t>(joint), parent = static_cast<std::size_t>(chains[c][k - 1]);
        const double length = norm(directions[j]);
        if (std::abs(length - 1) > 1e-6) {
          raise<config_error>(106, "ChainSkeleton '", name, "': the direction of joint ", j, " has length ", length);
        }
        placed[j] = true;
        out.push_back({j, parent, k == 1 ? 0 : parent});
      }
    }
    if (out.size() + 1 != size()) {
      raise<config_error>(106, "ChainSkeleton '", name, "': bones end at ", out.size(), " of ", size() - 1, " joints");
    }
    for (const int j : {face[0], face[1], face[2], face[3], leg[0], leg[1], left_foot[0], left_foot[1], right_foot[0],
                        right_foot[1]}) {
      if (!known(j)) raise<config_error>(106, "ChainSkeleton '", name, "': no joint ", j, " among ", size());
    }
    return out;
  }
  /// Throws as bones().
  void validate() const { bones(); }
  /// Parent of each joint, -1 for the root.
  std::vector<int> parents() const {
    std::vector<int> out(size(), -1);
    for (const ChainBone& b : bones()) out[b.joint] = static_cast<int>(b.parent);
    return out;
  }
};

/// HumanML3D: the first 22 joints of SMPL, metres, 20 frames per second. Lengths: first frame of its clip 000021.
inline const ChainSkeleton& humanml3d_chains() {
  static const ChainSkeleton skeleton{
      .name = "HumanML3D",
      .chains = {{0, 2, 5, 8, 11}, {0, 1, 4, 7, 10}, {0, 3, 6, 9, 12, 15}, {9, 14, 17, 19, 21}, {9, 13, 16, 18, 20}},
      .directions = {{0, 0, 0},  {1, 0, 0},  {-1, 0, 0}, {0, 1, 0},  {0, -1, 0}, {0, -1, 0}, {0, 1, 0},  {0, -1, 0},
                     {0, -1, 0}, {0, 1, 0},  {0, 0, 1},  {0, 0, 1},  {0, 1, 0},  {1, 0, 0},  {-1, 0, 0}, {0, 0, 1},
                     {0, -1, 0}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}, {0, -1, 0}},
      .face = {2, 1, 17, 16},
      .leg = {5, 8},
      .left_foot = {7, 10},
      .right_foot = {8, 11},
      .foot_threshold = 0.002,
      .fps = 20,
      .lengths = {0,          0.10307397, 0.10988337, 0.13156824, 0.3936232,  0.39018822, 0.14319022, 0.43243307,
                  0.42564335, 0.05736474, 0.14338182, 0.14941907, 0.21936005, 0.13748677, 0.14338283, 0.10303922,
                  0.13161404, 0.12298438, 0.25684,    0.26309174, 0.26601171, 0.2698764}};
  return skeleton;
}

/// KIT Motion-Language: 21 joints of the Master Motor Map, about 640 units per metre, 12.5 frames per second. The names
/// of the data set are mirrored: joints 11 ... 15 and 5 ... 7 ("L") are the right side of the body, and so they are
/// taken. The threshold is published in metres although the data are not, hence contacts are hardly ever on. The
/// lengths of the reference clip 03950 are not published.
inline const ChainSkeleton& kit_chains() {
  static const ChainSkeleton skeleton{
      .name = "KIT",
      .chains = {{0, 11, 12, 13, 14, 15}, {0, 16, 17, 18, 19, 20}, {0, 1, 2, 3, 4}, {3, 5, 6, 7}, {3, 8, 9, 10}},
      .directions = {{0, 0, 0},  {0, 1, 0},  {0, 1, 0},  {0, 1, 0},  {0, 1, 0},  {1, 0, 0},  {0, -1, 0},
                     {0, -1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, -1, 0}, {1, 0, 0},  {0, -1, 0}, {0, -1, 0},
                     {0, 0, 1},  {0, 0, 1},  {-1, 0, 0}, {0, -1, 0}, {0, -1, 0}, {0, 0, 1},  {0, 0, 1}},
      .face = {11, 16, 5, 8},
      .leg = {17, 18},
      .left_foot = {19, 20},
      .right_foot = {14, 15},
      .foot_threshold = 0.05,
      .fps = 12.5};
  return skeleton;
}

MOTIONLANG_NAMESPACE_END
