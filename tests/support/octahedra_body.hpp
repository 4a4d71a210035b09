// SPDX-License-Identifier: MIT
/// Body files that anybody may have: the joints of SMPL, SMPL-H or SMPL-X, an octahedron around each, one direction of
/// shape (taller).
#pragma once

#include <motionlang/file/npz.hpp>
#include <motionlang/kinematics/body_motion.hpp>
#include <motionlang/kinematics/known_skeletons.hpp>

namespace octahedra {

namespace ml = motionlang;
using ml::Index;

/// SMPL's joints, or the first 22 of them with fingers, and with jaw and eyes. The pelvis is not at the origin, as in
/// the real ones.
inline ml::Skeleton skeleton(ml::BodyKind kind) {
  const ml::Skeleton& smpl = ml::smpl24_skeleton();
  ml::Skeleton s;
  s.names = ml::body_joint_names(kind, ml::body_kinds[static_cast<std::size_t>(kind)].joints);
  for (const std::string& name : s.names) {
    const bool left = name.starts_with("left"), first = name.ends_with("1");
    if (const int j = smpl.find(name); j >= 0) {
      s.parents.push_back(smpl.parent(j));
      s.offsets.push_back(j == 0 ? ml::Vec3<double>{0.01, -0.22, 0.03} : smpl.offset(j));
    } else if (name == "jaw" || name.ends_with("_eye")) {
      s.parents.push_back(15);
      s.offsets.push_back({name == "jaw" ? 0 : left ? 0.03 : -0.03, name == "jaw" ? -0.03 : 0.05, 0.06});
    } else {
      s.parents.push_back(!first ? static_cast<int>(s.parents.size()) - 1 : left ? 20 : 21);
      s.offsets.push_back({left ? 0.03 : -0.03, 0, 0.01});
    }
  }
  s.validate();
  return s;
}

inline std::vector<ml::NamedArray> arrays(ml::BodyKind kind = ml::BodyKind::smpl) {
  const ml::Skeleton s = skeleton(kind);
  const Index joints = s.size(), vertices = 6 * joints;
  const auto sized = [](Index count) { return std::vector<float>(static_cast<std::size_t>(count)); };
  std::vector<float> points, taller, regressor = sized(joints * vertices), weights = sized(vertices * joints),
                                     pose_directions = sized(vertices * 27 * (joints - 1));
  std::vector<std::int64_t> tree, faces;
  const auto rest = s.rest_positions();
  for (Index j = 0; j < joints; ++j) {
    const auto& p = rest[static_cast<std::size_t>(j)];
    for (Index k = 0; k < 6; ++k) {
      const double r = k % 2 == 0 ? 0.05 : -0.05;
      const ml::Vec3<double> v{p.x + (k / 2 == 0 ? r : 0), p.y + (k / 2 == 1 ? r : 0), p.z + (k / 2 == 2 ? r : 0)};
      for (const double x : {v.x, v.y, v.z}) points.push_back(static_cast<float>(x));
      for (const double x : {0.0, 0.1 * v.y, 0.0}) taller.push_back(static_cast<float>(x));
      regressor[static_cast<std::size_t>(j * vertices + 6 * j + k)] = 1.0F / 6;
      weights[static_cast<std::size_t>((6 * j + k) * joints + j)] = 1;
    }
    for (const auto& f :
         {std::array{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}) {
      for (const int v : f) faces.push_back(6 * j + v);
    }
    tree.push_back(s.parent(static_cast<int>(j)));
  }
  for (Index j = 0; j < joints; ++j) tree.push_back(j);
  const auto floats = [](const std::vector<float>& v, std::vector<Index> shape) {
    return ml::NpyArray::of(std::span<const float>(v), std::move(shape));
  };
  const auto integers = [](const std::vector<std::int64_t>& v, std::vector<Index> shape) {
    return ml::NpyArray::of(std::span<const std::int64_t>(v), std::move(shape));
  };
  return {{"v_template", floats(points, {vertices, 3})},
          {"shapedirs", floats(taller, {vertices, 3, 1})},
          {"posedirs", floats(pose_directions, {vertices, 3, 9 * (joints - 1)})},
          {"J_regressor", floats(regressor, {joints, vertices})},
          {"weights", floats(weights, {vertices, joints})},
          {"kintree_table", integers(tree, {2, joints})},
          {"f", integers(faces, {std::ssize(faces) / 3, 3})}};
}

}  // namespace octahedra
