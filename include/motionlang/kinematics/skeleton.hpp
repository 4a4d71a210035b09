// SPDX-License-Identifier: MIT
/// A kinematic tree: names, parents and rest offsets of joints, depth first.
///
/// Established here and relied upon everywhere: parents[0] = -1, 0 <= parents[j] < j, names are unique. Algorithms over
/// a skeleton are therefore one loop over j in which the parent has been visited already.
#pragma once

#include <initializer_list>  // from_joints({...})
#include <span>              // joints
#include <string>            // names
#include <string_view>       // lookups
#include <vector>            // storage

#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One joint as it is written down: its parent by name ("" for the root) and its rest position relative to the parent,
/// metres.
struct Joint {
  std::string name;
  std::string parent;
  Vec3<double> offset;
};

struct Skeleton {
  std::vector<std::string> names;
  std::vector<int> parents;
  std::vector<Vec3<double>> offsets;
  /// Where the bones of joints without children end, relative to them: tips of toes and fingers, as BVH files have
  /// them. One for each joint, (0, 0, 0) where it is not known, or none at all.
  std::vector<Vec3<double>> ends{};

  /// From joints in an order in which parents come first. Throws config_error 106.
  static Skeleton from_joints(std::span<const Joint> joints) {
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
  static Skeleton from_joints(std::initializer_list<Joint> joints) {
    return from_joints(std::span<const Joint>(joints.begin(), joints.size()));
  }
  /// From arrays. Throws config_error 106.
  static Skeleton from_arrays(std::vector<std::string> names, std::vector<int> parents,
                              std::vector<Vec3<double>> offsets) {
    Skeleton s{std::move(names), std::move(parents), std::move(offsets)};
    s.validate();
    return s;
  }

  int size() const { return static_cast<int>(parents.size()); }

  /// Number of a joint, or -1.
  int find(std::string_view name) const {
    for (std::size_t j = 0; j < names.size(); ++j) {
      if (names[j] == name) return static_cast<int>(j);
    }
    return -1;
  }
  /// Number of a joint. Throws config_error 103.
  int operator[](std::string_view name) const {
    const int j = find(name);
    if (j < 0)
      raise<config_error>(103, "Skeleton: no joint '", name, "' among ", size(), " joints (root '",
                          names.empty() ? "" : names.front(), "')");
    return j;
  }

  int parent(int joint) const { return parents[static_cast<std::size_t>(joint)]; }
  const std::string& name(int joint) const { return names[static_cast<std::size_t>(joint)]; }
  const Vec3<double>& offset(int joint) const { return offsets[static_cast<std::size_t>(joint)]; }

  /// Children of a joint in order.
  std::vector<int> children(int joint) const {
    std::vector<int> out;
    for (int j = joint + 1; j < size(); ++j) {
      if (parent(j) == joint) out.push_back(j);
    }
    return out;
  }
  /// Rest positions relative to the same origin as the root's offset.
  std::vector<Vec3<double>> rest_positions() const {
    std::vector<Vec3<double>> p(offsets);
    for (int j = 1; j < size(); ++j) {
      p[static_cast<std::size_t>(j)] = p[static_cast<std::size_t>(parent(j))] + offset(j);
    }
    return p;
  }

  /// Throws config_error 106 unless the promises above hold.
  void validate() const {
    if (parents.empty()) raise<config_error>(106, "Skeleton: no joints");
    if (names.size() != parents.size() || offsets.size() != parents.size()) {
      raise<config_error>(106, "Skeleton: ", names.size(), " names, ", parents.size(), " parents, ", offsets.size(),
                          " offsets");
    }
    if (!ends.empty() && ends.size() != parents.size())
      raise<config_error>(106, "Skeleton: ", ends.size(), " ends of ", parents.size(), " joints");
    for (int j = 0; j < size(); ++j) {
      if (j == 0 ? parent(j) != -1 : parent(j) < 0 || parent(j) >= j) {
        raise<config_error>(
            106, "Skeleton: joint ", j, " '", name(j), "' has parent ", parent(j),
            j == 0 ? "; the first joint must be the root (-1)" : "; it must be one of the joints before");
      }
      if (find(name(j)) != j) raise<config_error>(106, "Skeleton: two joints are called '", name(j), "'");
    }
  }
  /// Poses of one fit the other: `ends` are of no account.
  bool operator==(const Skeleton& s) const { return names == s.names && parents == s.parents && offsets == s.offsets; }
};

MOTIONLANG_NAMESPACE_END
