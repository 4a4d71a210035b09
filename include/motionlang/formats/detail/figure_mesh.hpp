// SPDX-License-Identifier: MIT
/// The triangles of a figure. Every round cone is a closed surface of its own, in the rest pose.
#pragma once

#include <cstdint>  // indices
#include <vector>   // vertices

#include <motionlang/formats/figure.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

struct FigureMesh {
  std::vector<Vec3<float>> positions, normals;
  std::vector<std::uint16_t> joints;     // of each vertex: the joint that moves it
  std::vector<std::uint32_t> triangles;  // three vertices each, counter-clockwise from outside
};

FigureMesh make_mesh(const Figure& figure, const Skeleton& skeleton);

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/formats/detail/figure_mesh.ipp>
#endif
