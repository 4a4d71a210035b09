// SPDX-License-Identifier: MIT
/// Nodes of a glTF document.
#pragma once

#include <string>  // names
#include <vector>  // children

#include <motionlang/geometry/quaternion.hpp>
#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class JsonView;

namespace detail {

class GltfDocument;
class SharedAccessors;

/// Translation, rotation and scale of a node relative to its parent.
struct GltfTransform {
  Vec3<double> translation{};
  Quaternion<double> rotation = Quaternion<double>::identity();
  Vec3<double> scale{1, 1, 1};
};

struct GltfNode {
  std::string name;  // of a bone of VRM's humanoid that of the bone: "leftUpperLeg"
  int parent = -1;
  std::vector<int> children{};
  GltfTransform rest;
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
