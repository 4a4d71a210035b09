// SPDX-License-Identifier: MIT
// Bodies of skeleton_table.hpp.
#pragma once

#include <algorithm>  // equal
#include <vector>     // names

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

MOTIONLANG_BODY std::string common_name_prefix(const Skeleton& skeleton) {
  const std::size_t enough = (3 * skeleton.names.size() + 3) / 4;
  std::string prefix;
  std::vector<std::string_view> fitting(skeleton.names.begin(), skeleton.names.end());
  while (skeleton.size() > 3) {
    const std::size_t at = prefix.size();
    std::erase_if(fitting, [at](std::string_view name) { return name.size() <= at; });
    char next = 0;  // that of most names, if there is one
    std::size_t lead = 0;
    for (const std::string_view name : fitting) {
      if (lead == 0) next = name[at];
      lead = name[at] == next ? lead + 1 : lead - 1;
    }
    std::erase_if(fitting, [&](std::string_view name) { return name[at] != next; });
    if (fitting.size() < enough) break;
    prefix += next;
  }
  return prefix.substr(0, prefix.find_last_of("_:-. |") + 1);  // npos + 1 = 0
}

namespace detail {

/// Capital letters are as good as small ones, and "_" is as good as a blank.
inline bool similar_names(std::string_view a, std::string_view b) {
  const auto plain = [](char c) { return c == '_' ? ' ' : lower(c); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return plain(x) == plain(y); });
}

/// "Hips" of "Hips_01" and of "Hips.001"; else the whole name.
inline std::string_view without_number(std::string_view name) {
  const std::size_t last = name.find_last_not_of("0123456789");
  const bool numbered =
      last != name.npos && last > 0 && last + 1 < name.size() && (name[last] == '_' || name[last] == '.');
  return numbered ? name.substr(0, last) : name;
}

/// Names without what most of them begin with, and without numbers if three quarters end with one: Sketchfab numbers
/// all nodes of a file, and Blender the joints of a copy.
class SharedHabits {
 public:
  explicit SharedHabits(const Skeleton& skeleton) : prefix_(common_name_prefix(skeleton)) {
    std::size_t numbered = 0;
    for (const std::string& name : skeleton.names) numbered += without_number(name).size() < name.size() ? 1 : 0;
    numbered_ = 4 * numbered >= 3 * skeleton.names.size();
  }
  std::string_view bare(std::string_view name) const {
    if (name.starts_with(prefix_)) name.remove_prefix(prefix_.size());
    return bare_joint_name(numbered_ ? without_number(name) : name);
  }

 private:
  std::string prefix_;
  bool numbered_ = false;
};

}  // namespace detail

MOTIONLANG_BODY int find_joint(const Skeleton& skeleton, std::string_view name) {
  if (const int j = skeleton.find(name); j >= 0) return j;
  int similar = -1;
  bool ends_like = false;  // a name, except for its number: only then habits matter
  for (int k = 0; k < skeleton.size(); ++k) {
    const std::string_view whole = skeleton.name(k), bare = bare_joint_name(whole);
    if (bare == name) return k;
    if (similar < 0 && detail::similar_names(bare, name)) similar = k;
    const std::string_view core = detail::without_number(whole);
    const bool longer = core.size() >= name.size();
    ends_like = ends_like || (longer && detail::similar_names(core.substr(core.size() - name.size()), name));
  }
  if (similar >= 0 || !ends_like) return similar;
  const detail::SharedHabits habits(skeleton);
  for (int k = 0; k < skeleton.size() && similar < 0; ++k) {
    if (detail::similar_names(habits.bare(skeleton.name(k)), name)) similar = k;
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
