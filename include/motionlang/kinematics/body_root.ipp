// SPDX-License-Identifier: MIT
// Bodies of body_root.hpp.
#pragma once

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
