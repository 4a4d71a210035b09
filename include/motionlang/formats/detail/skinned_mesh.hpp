// SPDX-License-Identifier: MIT
/// A surface that follows joints, in the form that files and pages need.
#pragma once

#include <cstdint>  // numbers of joints
#include <vector>   // vertices

#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// A surface at rest whose vertices follow four joints each. W: std::uint8_t or std::uint16_t; its largest value means
/// 1.
template <class W>
struct SkinnedMesh {
  std::vector<Vec3<float>> positions, normals;
  std::vector<std::uint16_t> joints;  // four for each vertex
  std::vector<W> weights;             // four for each vertex, with the sum 1
  std::vector<std::uint32_t> triangles;
};

}  // namespace detail
MOTIONLANG_NAMESPACE_END
