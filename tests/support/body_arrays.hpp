// SPDX-License-Identifier: MIT
/// The arrays of a body's file, of any number of joints and vertices.
#pragma once

#include <motionlang/file/npz.hpp>

#include "synthetic_body.hpp"

namespace body_arrays {

namespace ml = motionlang;
using ml::Index;

inline ml::NpyArray array(const std::vector<double>& values, std::vector<Index> shape) {
  return ml::NpyArray::of(std::span<const double>(values), std::move(shape));
}
inline std::vector<double> numbers(Index count) { return synthetic::wave(1, static_cast<int>(count)); }

/// A body of `vertices` vertices and a chain of joints, with directions of shape.
inline std::vector<ml::NamedArray> chain(Index joints, Index vertices, Index directions) {
  std::vector<double> kintree, weights, regressor;
  for (Index j = 0; j < joints; ++j) kintree.push_back(j == 0 ? 4294967295.0 : static_cast<double>(j - 1));
  for (Index j = 0; j < joints; ++j) kintree.push_back(static_cast<double>(j));
  for (Index v = 0; v < vertices; ++v) {
    for (Index j = 0; j < joints; ++j) weights.push_back(j == 0 ? 1 : 0);
  }
  return {{"v_template", array(numbers(vertices * 3), {vertices, 3})},
          {"shapedirs", array(numbers(vertices * 3 * directions), {vertices, 3, directions})},
          {"posedirs", array(numbers(vertices * 27 * (joints - 1)), {vertices, 3, 9 * (joints - 1)})},
          {"J_regressor", array(numbers(joints * vertices), {joints, vertices})},
          {"weights", array(weights, {vertices, joints})},
          {"kintree_table", array(kintree, {2, joints})},
          {"f", ml::NpyArray::of(std::span<const std::int64_t>(), {0, 3})}};
}

}  // namespace body_arrays
