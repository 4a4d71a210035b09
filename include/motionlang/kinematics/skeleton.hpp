// SPDX-License-Identifier: MIT
/// A kinematic tree: names, parents and rest offsets of joints, depth first.
///
/// Every skeleton guarantees this: parents[0] = -1, 0 <= parents[j] < j, names are unique. So algorithms over a
/// skeleton are one loop over j, which visits the parent first.
#pragma once

#include <initializer_list>  // from_joints({...})
#include <span>              // joints
#include <string>            // names
#include <string_view>       // lookups
#include <vector>            // storage

#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One joint in its written form: its parent by name ("" for the root) and its rest position relative to the parent,
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
  /// The ends of the bones of joints without children, relative to them: tips of toes and fingers, as in BVH files. One
  /// for each joint, (0, 0, 0) if it is not known, or none at all.
  std::vector<Vec3<double>> ends{};

  /// From joints in an order in which parents come first. Throws config_error 106.
  static Skeleton from_joints(std::span<const Joint> joints);
  static Skeleton from_joints(std::initializer_list<Joint> joints) {
    return from_joints(std::span<const Joint>(joints.begin(), joints.size()));
  }
  /// From arrays. Throws config_error 106.
  static Skeleton from_arrays(std::vector<std::string> names, std::vector<int> parents,
                              std::vector<Vec3<double>> offsets);

  int size() const { return static_cast<int>(parents.size()); }

  /// Number of a joint, or -1.
  int find(std::string_view name) const;
  /// Number of a joint. Throws config_error 103.
  int operator[](std::string_view name) const;

  int parent(int joint) const { return parents[static_cast<std::size_t>(joint)]; }
  const std::string& name(int joint) const { return names[static_cast<std::size_t>(joint)]; }
  const Vec3<double>& offset(int joint) const { return offsets[static_cast<std::size_t>(joint)]; }

  /// Children of a joint in order.
  std::vector<int> children(int joint) const;
  /// Rest positions relative to the same origin as the root's offset.
  std::vector<Vec3<double>> rest_positions() const;

  /// Throws config_error 106 unless the promises above hold.
  void validate() const;
  /// True if poses of one fit the other. `ends` do not count.
  bool operator==(const Skeleton& s) const { return names == s.names && parents == s.parents && offsets == s.offsets; }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/kinematics/skeleton.ipp>
#endif
