// SPDX-License-Identifier: MIT
// Bodies of guo_chains.hpp.
#pragma once

#include <cmath>  // abs

#include <motionlang/kinematics/guo_chains.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<ChainBone> ChainSkeleton::bones() const {
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
  for (const int j :
       {face[0], face[1], face[2], face[3], leg[0], leg[1], left_foot[0], left_foot[1], right_foot[0], right_foot[1]}) {
    if (!known(j)) raise<config_error>(106, "ChainSkeleton '", name, "': no joint ", j, " among ", size());
  }
  return out;
}

MOTIONLANG_BODY std::vector<int> ChainSkeleton::parents() const {
  std::vector<int> out(size(), -1);
  for (const ChainBone& b : bones()) out[b.joint] = static_cast<int>(b.parent);
  return out;
}

MOTIONLANG_BODY const ChainSkeleton& humanml3d_chains() {
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

MOTIONLANG_BODY const ChainSkeleton& kit_chains() {
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
