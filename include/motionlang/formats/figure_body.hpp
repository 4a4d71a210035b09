// SPDX-License-Identifier: MIT
/// A free body: the figure of any skeleton (formats/figure.hpp, the round cones in GLB files and pages) as a body
/// model. So every motion has vertices and faces without a licensed file. A vertex follows one joint; there are no
/// blend shapes.
///
///     auto body = figure_body<EigenBackend<float>>(motion.skeleton);
///     auto posed = pose_body(body.model, motion);                       // vertices (frames, V, 3)
#pragma once

#include <motionlang/formats/detail/figure_mesh.hpp>
#include <motionlang/kinematics/body.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Weights that give each joint's rest position as an affine combination of the vertices, (joints, vertices). Of all
/// such weights, they are the smallest:
///     w_i = 1 / V + (x_i - c) C^-1 (p - c),   c = mean of x,   C = sum (x_i - c) (x_i - c)^T
template <class S>
std::vector<S> rest_regressor(const std::vector<Vec3<float>>& vertices, const std::vector<Vec3<double>>& joints) {
  const auto count = static_cast<double>(vertices.size());
  Vec3<double> centre{};
  for (const auto& v : vertices) centre = centre + 1 / count * vec_cast<double>(v);
  Vec3<double> a{}, b{}, c{};  // columns of C
  for (const auto& v : vertices) {
    const Vec3<double> d = vec_cast<double>(v) - centre;
    a = a + d.x * d, b = b + d.y * d, c = c + d.z * d;
  }
  const double determinant = dot(a, cross(b, c));
  std::vector<S> out;
  for (const Vec3<double>& joint : joints) {
    const Vec3<double> p = joint - centre;
    const Vec3<double> solved{dot(p, cross(b, c)), dot(p, cross(c, a)), dot(p, cross(a, b))};
    for (const auto& v : vertices) {
      out.push_back(static_cast<S>(1 / count + dot(vec_cast<double>(v) - centre, solved) / determinant));
    }
  }
  return out;
}

}  // namespace detail

/// A body of kind `other` with the joints of the skeleton, in its rest pose; metres.
template <Backend B>
Body<B> figure_body(const Skeleton& skeleton) {
  using S = typename B::scalar;
  const detail::FigureMesh mesh = detail::make_mesh(make_figure(skeleton), skeleton);
  const auto vertices = static_cast<Index>(mesh.positions.size());
  const Index joints = skeleton.size();
  std::vector<S> points, weights(static_cast<std::size_t>(vertices * joints), S(0));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto& p = mesh.positions[v];
    points.insert(points.end(), {static_cast<S>(p.x), static_cast<S>(p.y), static_cast<S>(p.z)});
    weights[v * static_cast<std::size_t>(joints) + mesh.joints[v]] = S(1);
  }
  Body<B> body;
  body.model.v_template = Tensor<B, 2>::from(points, {vertices, 3});
  body.model.shapedirs = body.model.posedirs = Tensor<B, 2>::zeros({3 * vertices, 0});
  body.model.J_regressor =
      Tensor<B, 2>::from(detail::rest_regressor<S>(mesh.positions, skeleton.rest_positions()), {joints, vertices});
  body.model.weights = Tensor<B, 2>::from(weights, {vertices, joints});
  body.model.parents = skeleton.parents;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    body.faces.push_back({static_cast<Index>(mesh.triangles[i]), static_cast<Index>(mesh.triangles[i + 1]),
                          static_cast<Index>(mesh.triangles[i + 2])});
  }
  return body;
}

MOTIONLANG_NAMESPACE_END
