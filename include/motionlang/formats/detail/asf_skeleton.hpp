// SPDX-License-Identifier: MIT
/// The skeleton of an ASF file, unchanged.
#pragma once

#include <string>       // names
#include <string_view>  // lookups
#include <vector>       // bones

#include <motionlang/geometry/quaternion.hpp>
#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One value of a bone in an AMC frame: along or about an axis (0, 1, 2), or its length (dof "l").
struct AsfChannel {
  enum class Kind { translation, rotation, length };
  Kind kind;
  int axis = 0;
};

struct AsfBone {
  std::string name;
  int parent = -1;                      // number of the bone; -1 for the root
  Vec3<double> end{};                   // of the bone, seen from its start, in units of the file
  Quaternion<double> axis{1, 0, 0, 0};  // the frame of the angles (C)
  std::vector<AsfChannel> channels{};   // in the order of the values in the AMC file
};

/// Bone 0 is the root, which has no extent (its `end` is the position given in the file). Parents come before their
/// children.
struct AsfSkeleton {
  std::vector<AsfBone> bones;
  double metres_per_unit = 0.0254;  // CMU: ":units length 0.45" means inches / 0.45
  bool degrees = true;
  std::string name{};

  /// Number of a bone, or -1.
  int find(std::string_view bone) const {
    for (std::size_t b = 0; b < bones.size(); ++b) {
      if (bones[b].name == bone) return static_cast<int>(b);
    }
    return -1;
  }
};

MOTIONLANG_NAMESPACE_END
