// SPDX-License-Identifier: MIT
// Bodies of skeleton.hpp.
#pragma once

#include <motionlang/kinematics/skeleton.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Skeleton Skeleton::from_joints(std::span<const Joint> joints) {
  Skeleton s;
  for (const Joint& j : joints) {
    const int parent = j.parent.empty() ? -1 : s.find(j.parent);
    if (!j.parent.empty() && parent < 0) {
      raise<config_error>(106, "Skeleton: parent '", j.parent, "' of '", j.name, "' does not come before it");
    }
    s.names.push_back(j.name);
    s.parents.push_back(parent);
    s.offsets.push_back(j.offset);
  }
  s.validate();
  return s;
}

MOTIONLANG_BODY Skeleton Skeleton::from_arrays(std::vector<std::string> names, std::vector<int> parents,
                                               std::vector<Vec3<double>> offsets) {
  Skeleton s{std::move(names), std::move(parents), std::move(offsets)};
  s.validate();
  return s;
}

MOTIONLANG_BODY int Skeleton::find(std::string_view name) const {
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (names[j] == name) return static_cast<int>(j);
  }
  return -1;
}

MOTIONLANG_BODY int Skeleton::operator[](std::string_view name) const {
  const int j = find(name);
  if (j < 0)
    raise<config_error>(103, "Skeleton: no joint '", name, "' among ", size(), " joints (root '",
                        names.empty() ? "" : names.front(), "')");
  return j;
}

MOTIONLANG_BODY std::vector<int> Skeleton::children(int joint) const {
  std::vector<int> out;
  for (int j = joint + 1; j < size(); ++j) {
    if (parent(j) == joint) out.push_back(j);
  }
  return out;
}

MOTIONLANG_BODY std::vector<Vec3<double>> Skeleton::rest_positions() const {
  std::vector<Vec3<double>> p(offsets);
  for (int j = 1; j < size(); ++j) {
    p[static_cast<std::size_t>(j)] = p[static_cast<std::size_t>(parent(j))] + offset(j);
  }
  return p;
}

MOTIONLANG_BODY void Skeleton::validate() const {
  if (parents.empty()) raise<config_error>(106, "Skeleton: no joints");
  if (names.size() != parents.size() || offsets.size() != parents.size()) {
    raise<config_error>(106, "Skeleton: ", names.size(), " names, ", parents.size(), " parents, ", offsets.size(),
                        " offsets");
  }
  if (!ends.empty() && ends.size() != parents.size())
    raise<config_error>(106, "Skeleton: ", ends.size(), " ends of ", parents.size(), " joints");
  for (int j = 0; j < size(); ++j) {
    if (j == 0 ? parent(j) != -1 : parent(j) < 0 || parent(j) >= j) {
      raise<config_error>(106, "Skeleton: joint ", j, " '", name(j), "' has parent ", parent(j),
                          j == 0 ? "; the first joint must be the root (-1)" : "; it must be one of the joints before");
    }
    if (find(name(j)) != j) raise<config_error>(106, "Skeleton: two joints are called '", name(j), "'");
  }
}

MOTIONLANG_NAMESPACE_END
