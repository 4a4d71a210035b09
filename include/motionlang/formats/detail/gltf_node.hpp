// SPDX-License-Identifier: MIT
/// Nodes of a glTF document, and their places in the world.
#pragma once

#include <cmath>     // sqrt
#include <optional>  // sheared matrices
#include <string>    // names
#include <vector>    // children

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
  /// The linear part of a matrix that is not a rotation times a scale. It replaces both.
  std::optional<Matrix3<double>> sheared{};
};

struct GltfNode {
  std::string name;  // for a bone of VRM's humanoid the name of the bone: "leftUpperLeg"
  int parent = -1;
  std::vector<int> children{};
  GltfTransform rest;
  bool is_bone = false;   // of VRM's humanoid
  bool is_thing = false;  // has a mesh, a camera or a light
};

/// The determinant of a matrix of three rows.
inline double determinant(const Matrix3<double>& a) { return dot(a.row(0), cross(a.row(1), a.row(2))); }

/// The inverse of a matrix, transposed, by its cofactors. Its determinant must not be 0.
inline Matrix3<double> inverse_transposed(const Matrix3<double>& a) {
  const double s = 1 / determinant(a);
  return Matrix3<double>::from_rows(s * cross(a.row(1), a.row(2)), s * cross(a.row(2), a.row(0)),
                                    s * cross(a.row(0), a.row(1)));
}

/// The rotation, or rotation and reflection, that is closest to a matrix: the orthogonal factor of its polar
/// decomposition. None for a matrix without an inverse.
/// Source  Higham, "Computing the polar decomposition, with applications" (1986), Newton's iteration with scaling
inline std::optional<Matrix3<double>> nearest_orthogonal(Matrix3<double> a) {
  const auto length = [](const Matrix3<double>& m) {
    double sum = 0;
    for (const double x : m.m) sum += x * x;
    return std::sqrt(sum);
  };
  const double size = length(a);
  if (!(size > 1e-100 && size < 1e100)) return std::nullopt;
  for (double& x : a.m) x /= size;
  if (!(std::abs(determinant(a)) > 1e-12)) return std::nullopt;
  for (int i = 0; i < 40; ++i) {
    const Matrix3<double> b = inverse_transposed(a);
    const double scale = i < 8 ? std::sqrt(length(b) / length(a)) : 1;
    double change = 0;
    for (std::size_t k = 0; k < 9; ++k) {
      const double next = 0.5 * (scale * a.m[k] + b.m[k] / scale);
      change += std::abs(next - a.m[k]);
      a.m[k] = next;
    }
    if (change < 1e-15) break;
  }
  return a;
}

/// A node in the world: x -> linear x + place, the product of the matrices from the top of the tree.
struct GltfPlace {
  Vec3<double> place{};
  Matrix3<double> linear = Matrix3<double>::identity();
  Quaternion<double> turn = Quaternion<double>::identity();  // the product of the rotations only
  bool even = true;                                          // linear is `turn` times a positive number

  /// The place of a node below this one.
  friend GltfPlace operator*(const GltfPlace& parent, const GltfTransform& t) {
    GltfPlace out;
    out.place = parent.place + parent.linear * t.translation;
    const Vec3<double>& s = t.scale;
    Matrix3<double> local = to_matrix(t.rotation);
    for (int row = 0; row < 3; ++row) local(row, 0) *= s.x, local(row, 1) *= s.y, local(row, 2) *= s.z;
    out.linear = parent.linear * (t.sheared ? *t.sheared : local);
    out.turn = normalized(parent.turn * t.rotation);
    constexpr double same = 1e-6;  // scales in files are floats
    out.even =
        parent.even && !t.sheared && s.x > 0 && std::abs(s.y - s.x) <= same * s.x && std::abs(s.z - s.x) <= same * s.x;
    return out;
  }

  /// The axes of the node in the world: orthogonal, left-handed in a mirror image.
  Matrix3<double> axes() const { return even ? to_matrix(turn) : nearest_orthogonal(linear).value_or(to_matrix(turn)); }
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END
