// SPDX-License-Identifier: MIT
// Bodies of skeleton_table.hpp.
#pragma once

#include <algorithm>  // equal

#include <motionlang/core/text_lines.hpp>
#include <motionlang/kinematics/skeleton_table.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string_view bare_joint_name(std::string_view name) {
  name = name.substr(name.rfind(':') + 1);  // npos + 1 = 0
  constexpr std::string_view mixamo = "mixamorig";
  if (!name.starts_with(mixamo)) return name;
  const std::size_t rest = name.find_first_not_of("0123456789_", mixamo.size());
  return rest == name.npos ? name : name.substr(rest);
}

namespace detail {

inline bool same_but_for_capitals(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace detail

MOTIONLANG_BODY int find_joint(const Skeleton& skeleton, std::string_view name) {
  if (const int j = skeleton.find(name); j >= 0) return j;
  int similar = -1;
  for (int k = 0; k < skeleton.size(); ++k) {
    const std::string_view bare = bare_joint_name(skeleton.name(k));
    if (bare == name) return k;
    if (similar < 0 && detail::same_but_for_capitals(bare, name)) similar = k;
  }
  return similar;
}

MOTIONLANG_BODY const MappedJoint* SkeletonTable::find(std::string_view target) const {
  for (const MappedJoint& j : joints) {
    if (j.target == target) return &j;
  }
  return nullptr;
}

MOTIONLANG_BODY std::string SkeletonTable::missing(const Skeleton& source) const {
  for (const MappedJoint& j : joints) {
    if (!j.optional() && find_joint(source, j.source) < 0) return j.source;
    if (!j.second.empty() && find_joint(source, j.second) < 0) return j.second;
  }
  return {};
}

MOTIONLANG_BODY int SkeletonTable::found(const Skeleton& source) const {
  int n = 0;
  for (const MappedJoint& j : joints) n += find_joint(source, j.source) >= 0 ? 1 : 0;
  return n;
}

MOTIONLANG_NAMESPACE_END
