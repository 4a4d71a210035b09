// SPDX-License-Identifier: MIT
// Bodies of body_root.hpp.
#pragma once

#include <algorithm>  // max

#include <motionlang/kinematics/body_root.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY int body_root(const Skeleton& skeleton, const SkeletonTable& table) {
  if (!table.missing(skeleton).empty()) return -1;
  int root = -1;
  const auto add = [&](int joint) {  // parents have lower numbers: the higher one goes up until both are the same
    if (root < 0) root = joint;
    for (int other = joint; other != root;)
      (other > root ? other : root) = skeleton.parent(other > root ? other : root);
  };
  for (const MappedJoint& m : table.joints) {
    if (!m.optional()) add(find_joint(skeleton, m.source));
    if (!m.second.empty()) add(find_joint(skeleton, m.second));
  }
  return root;
}

MOTIONLANG_BODY int body_root(const Skeleton& skeleton) {
  const SkeletonTable* table = find_skeleton_table(skeleton);
  return table == nullptr ? 0 : body_root(skeleton, *table);
}

MOTIONLANG_BODY int moving_root(const Skeleton& skeleton, std::span<const JointMovement> movements) {
  const auto joints = static_cast<std::size_t>(skeleton.size());
  std::vector<int> count(joints, 1);        // joints below, with the joint itself
  std::vector<double> reach(joints, 0);     // length of the longest chain of bones below
  std::vector<bool> lively(joints, false);  // true if it or a joint below it moves or turns
  std::vector<std::vector<int>> children(joints);
  for (int j = skeleton.size() - 1; j >= 0; --j) {
    const auto here = static_cast<std::size_t>(j);
    if (movements[here].way > 0 || movements[here].turns) lively[here] = true;
    if (j == 0) break;
    const auto p = static_cast<std::size_t>(skeleton.parent(j));
    count[p] += count[here];
    reach[p] = std::max(reach[p], reach[here] + norm(skeleton.offset(j)));
    if (lively[here]) lively[p] = true;
    children[p].push_back(j);
  }
  const auto next = [&](int root) {
    int best = -1, most = 0;
    bool may_be_root = movements[static_cast<std::size_t>(root)].way > 0;
    for (const int c : children[static_cast<std::size_t>(root)]) {
      const auto child = static_cast<std::size_t>(c);
      if (movements[child].way > 0 && count[child] > most) best = c, most = count[child];
    }
    for (const int c : children[static_cast<std::size_t>(root)])
      may_be_root = may_be_root || (c != best && lively[static_cast<std::size_t>(c)]);
    if (best < 0 || children[static_cast<std::size_t>(root)].size() == 1) return best;
    const auto chosen = static_cast<std::size_t>(best);
    const bool is_most = 2 * most > count[static_cast<std::size_t>(root)] - 1;
    return is_most && movements[chosen].way > (may_be_root ? 1 : 0.1) * reach[chosen] ? best : -1;
  };
  int root = 0;
  for (int n = next(root); n >= 0; n = next(root)) root = n;
  return root;
}

MOTIONLANG_BODY std::vector<int> joints_from(const Skeleton& skeleton, int joint) {
  std::vector<int> out{joint};
  std::vector<bool> below(static_cast<std::size_t>(skeleton.size()), false);
  below[static_cast<std::size_t>(joint)] = true;
  for (int j = joint + 1; j < skeleton.size(); ++j) {
    if (!below[static_cast<std::size_t>(skeleton.parent(j))]) continue;
    below[static_cast<std::size_t>(j)] = true;
    out.push_back(j);
  }
  return out;
}

MOTIONLANG_BODY Skeleton skeleton_from(const Skeleton& skeleton, int joint) {
  Skeleton out;
  std::vector<int> number(static_cast<std::size_t>(skeleton.size()), -1);
  for (const int j : joints_from(skeleton, joint)) {
    const auto at = static_cast<std::size_t>(j);
    number[at] = out.size();
    out.names.push_back(skeleton.names[at]);
    out.parents.push_back(j == joint ? -1 : number[static_cast<std::size_t>(skeleton.parents[at])]);
    out.offsets.push_back(j == joint ? skeleton.rest_positions()[at] : skeleton.offsets[at]);
    if (!skeleton.ends.empty()) out.ends.push_back(skeleton.ends[at]);
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
