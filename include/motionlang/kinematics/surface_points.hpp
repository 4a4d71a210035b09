// SPDX-License-Identifier: MIT
/// Points on the surface of a body that move with it, such as face landmarks.
///
///     point = w_0 v_a + w_1 v_b + w_2 v_c      on the triangle (a, b, c)
/// Source  vchoutas/smplx smplx/lbs.py vertices2landmarks; lmk_faces_idx and lmk_bary_coords of the model files
#pragma once

#include <array>   // corners
#include <vector>  // points

#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct SurfacePoints {
  std::vector<std::array<Index, 3>> corners;   // vertices of the triangle of each point
  std::vector<std::array<double, 3>> weights;  // of its corners

  Index size() const { return static_cast<Index>(corners.size()); }
};

/// vertices (N, V, 3) -> (N, points, 3). Differentiable. Throws shape_error 203 for a vertex that does not exist, and
/// 204 unless each point has weights.
template <Backend B>
Tensor<B, 3> surface_points(const Tensor<B, 3>& vertices, const SurfacePoints& points) {
  using S = typename B::scalar;
  if (points.weights.size() != points.corners.size()) {
    raise<shape_error>(204, "surface_points: ", points.corners.size(), " points, ", points.weights.size(), " weights");
  }
  const auto by_vertex = permute(vertices, {1, 0, 2});
  const auto corner = [&](std::size_t k) {
    std::vector<Index> numbers;
    std::vector<S> weights;
    for (std::size_t i = 0; i < points.corners.size(); ++i) {
      numbers.push_back(points.corners[i][k]);
      weights.push_back(static_cast<S>(points.weights[i][k]));
    }
    return gather(by_vertex, numbers) * Tensor<B, 3>::from(weights, {points.size(), 1, 1});
  };
  return permute(corner(0) + corner(1) + corner(2), {1, 0, 2});
}

MOTIONLANG_NAMESPACE_END
