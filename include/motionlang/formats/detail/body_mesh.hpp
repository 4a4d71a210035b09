// SPDX-License-Identifier: MIT
/// The surface of a body at rest as a mesh with a skin.
#pragma once

#include <motionlang/formats/detail/skinned_mesh.hpp>
#include <motionlang/kinematics/body_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The four largest weights of a vertex with their joints, as shares of 65535.
struct FourWeights {
  std::array<std::uint16_t, 4> joints{}, weights{};
};
template <class S>
FourWeights four_weights(std::span<const S> row) {
  FourWeights out;
  std::array<double, 4> largest{};
  for (std::size_t j = 0; j < row.size(); ++j) {
    double w = static_cast<double>(row[j]);
    auto joint = static_cast<std::uint16_t>(j);
    for (std::size_t k = 0; k < 4; ++k) {
      if (w > largest[k]) std::swap(w, largest[k]), std::swap(joint, out.joints[k]);
    }
  }
  const double sum = largest[0] + largest[1] + largest[2] + largest[3];
  int left = 65535;
  for (std::size_t k = 4; k-- > 1;) {
    const int share = sum > 0 ? static_cast<int>(std::lround(65535 * largest[k] / sum)) : 0;
    out.weights[k] = static_cast<std::uint16_t>(share);
    if (share == 0) out.joints[k] = 0;
    left -= share;
  }
  out.weights[0] = static_cast<std::uint16_t>(left);
  return out;
}

/// The surface at rest for one shape, with a normal for every vertex: the mean of its faces', by their areas.
template <Backend B>
SkinnedMesh<std::uint16_t> body_mesh(const Body<B>& body, std::span<const typename B::scalar> betas) {
  const BodyModel<B>& model = body.model;
  const auto vertices = static_cast<std::size_t>(model.vertices()), joints = static_cast<std::size_t>(model.joints());
  const auto points = model.v_template.span(), directions = model.shapedirs.span(), weights = model.weights.span();
  SkinnedMesh<std::uint16_t> mesh;
  for (std::size_t v = 0; v < vertices; ++v) {
    std::array<double, 3> p{};
    for (std::size_t c = 0; c < 3; ++c) {
      p[c] = static_cast<double>(points[3 * v + c]);
      const std::size_t row = (3 * v + c) * static_cast<std::size_t>(model.shapedirs.size(1));
      for (std::size_t k = 0; k < betas.size(); ++k) p[c] += static_cast<double>(directions[row + k] * betas[k]);
    }
    mesh.positions.push_back(vec_cast<float>(Vec3<double>{p[0], p[1], p[2]}));
    const FourWeights four = four_weights(weights.subspan(v * joints, joints));
    mesh.joints.insert(mesh.joints.end(), four.joints.begin(), four.joints.end());
    mesh.weights.insert(mesh.weights.end(), four.weights.begin(), four.weights.end());
  }
  std::vector<Vec3<double>> normals(vertices);
  for (const auto& face : body.faces) {
    const auto at = [&](std::size_t k) { return vec_cast<double>(mesh.positions[static_cast<std::size_t>(face[k])]); };
    const Vec3<double> area = cross(at(1) - at(0), at(2) - at(0));
    for (const Index v : face) {
      normals[static_cast<std::size_t>(v)] = normals[static_cast<std::size_t>(v)] + area;
      mesh.triangles.push_back(static_cast<std::uint32_t>(v));
    }
  }
  for (const Vec3<double>& n : normals) {
    mesh.normals.push_back(vec_cast<float>(norm(n) > 0 ? normalized(n) : Vec3<double>{0, 1, 0}));
  }
  return mesh;
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
