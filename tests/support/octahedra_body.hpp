// SPDX-License-Identifier: MIT
/// A body file that anybody may have: SMPL's 24 joints, an octahedron around each, one direction of shape (taller).
#pragma once

#include <motionlang/io/npz.hpp>
#include <motionlang/kinematics/standard.hpp>

namespace octahedra {

namespace ml = motionlang;
using ml::Index;

inline constexpr Index vertices = 6 * 24;

inline std::vector<ml::NamedArray> arrays() {
  const ml::Skeleton& s = ml::smpl24_skeleton();
  std::vector<float> points, taller, regressor(24 * vertices), weights(vertices * 24),
      pose_directions(vertices * 3 * 207);
  std::vector<std::int64_t> tree, faces;
  const auto rest = s.rest_positions();
  for (Index j = 0; j < 24; ++j) {
    const auto& p = rest[static_cast<std::size_t>(j)];
    for (Index k = 0; k < 6; ++k) {
      const double r = k % 2 == 0 ? 0.05 : -0.05;
      const ml::Vec3<double> v{p.x + (k / 2 == 0 ? r : 0), p.y + (k / 2 == 1 ? r : 0), p.z + (k / 2 == 2 ? r : 0)};
      for (const double x : {v.x, v.y, v.z}) points.push_back(static_cast<float>(x));
      for (const double x : {0.0, 0.1 * v.y, 0.0}) taller.push_back(static_cast<float>(x));
      regressor[static_cast<std::size_t>(j * vertices + 6 * j + k)] = 1.0F / 6;
      weights[static_cast<std::size_t>((6 * j + k) * 24 + j)] = 1;
    }
    for (const auto& f :
         {std::array{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}) {
      for (const int v : f) faces.push_back(6 * j + v);
    }
    tree.push_back(s.parent(static_cast<int>(j)));
  }
  for (Index j = 0; j < 24; ++j) tree.push_back(j);
  const auto floats = [](const std::vector<float>& v, std::vector<Index> shape) {
    return ml::NpyArray::of(std::span<const float>(v), std::move(shape));
  };
  const auto integers = [](const std::vector<std::int64_t>& v, std::vector<Index> shape) {
    return ml::NpyArray::of(std::span<const std::int64_t>(v), std::move(shape));
  };
  return {{"v_template", floats(points, {vertices, 3})},
          {"shapedirs", floats(taller, {vertices, 3, 1})},
          {"posedirs", floats(pose_directions, {vertices, 3, 207})},
          {"J_regressor", floats(regressor, {24, vertices})},
          {"weights", floats(weights, {vertices, 24})},
          {"kintree_table", integers(tree, {2, 24})},
          {"f", integers(faces, {std::ssize(faces) / 3, 3})}};
}

}  // namespace octahedra
