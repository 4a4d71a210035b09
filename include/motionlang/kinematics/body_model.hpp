// SPDX-License-Identifier: MIT
/// Linear blend skinning with shape and pose blend shapes: the forward pass of SMPL, SMPL-H and SMPL-X, over any backend.
///
/// Source    Loper et al. (2015), eq. 2-12; spec body-models.md 1. The model's arrays come from the user's own file.
/// Notation  V vertices, J joints, K shape coefficients, N poses; beta -> betas, R_j -> rotations, tau -> translation
/// Differs   from the smplx package: rest joints come from the regressor folded into template and shape directions, which is
///           the same sum in another order
#pragma once

#include <motionlang/core/fields.hpp>
#include <motionlang/kinematics/forward.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/module.hpp>
#include <motionlang/tensor/ops.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// Posed points. vertices (N, V, 3), joints (N, J, 3), extra (N, E, 3): points picked from the vertices.
template <Backend B>
struct PosedBody {
  Tensor<B, 3> vertices, joints, extra;
};

template <Backend B>
struct BodyModel {
  static constexpr bool trainable = false;
  Tensor<B, 2> v_template;   // (V, 3)
  Tensor<B, 2> shapedirs;    // (3 V, K)
  Tensor<B, 2> posedirs;     // (3 V, 9 (J - 1))
  Tensor<B, 2> J_regressor;  // (J, V)
  Tensor<B, 2> weights;      // (V, J)
  std::vector<int> parents;  // -1 for the root
  std::vector<Index> extra;  // vertex numbers of the extra joints

  static constexpr auto fields() {
    using M = BodyModel;
    return motionlang::fields("v_template", &M::v_template, "shapedirs", &M::shapedirs, "posedirs", &M::posedirs,
                              "J_regressor", &M::J_regressor, "weights", &M::weights, "parents", &M::parents, "extra",
                              &M::extra);
  }

  Index vertices() const { return v_template.size(0); }
  Index joints() const { return static_cast<Index>(parents.size()); }

  /// Throws shape_error 204 if the arrays do not fit together, config_error 106 if a parent does not come before its child.
  void validate() const {
    const Index v = vertices(), j = joints();
    if (shapedirs.size(0) != 3 * v || posedirs.shape() != Shape{3 * v, 9 * (j - 1)} ||
        J_regressor.shape() != Shape{j, v} || weights.shape() != Shape{v, j}) {
      raise<shape_error>(204, "BodyModel: ", v, " vertices, ", j, " joints, but shapedirs ", shapedirs.shape(),
                         ", posedirs ", posedirs.shape(), ", J_regressor ", J_regressor.shape(), ", weights ",
                         weights.shape());
    }
    for (std::size_t i = 0; i < parents.size(); ++i) {
      if (i == 0 ? parents[i] != -1 : parents[i] < 0 || parents[i] >= static_cast<int>(i)) {
        raise<config_error>(106, "BodyModel: joint ", i, " has parent ", parents[i]);
      }
    }
    for (Index e : extra) {
      if (e < 0 || e >= v) raise<config_error>(101, "BodyModel: extra joint at vertex ", e, " of ", v);
    }
  }

  /// Rest positions of the joints for a shape: (N, 3 J).
  Tensor<B, 2> rest_joints(const Tensor<B, 2>& betas) const {
    const Index v = vertices(), j = joints(), k = shapedirs.size(1);
    auto regress = [&](const Tensor<B, 2>& t, Index columns) {
      return reshape<2>(matmul(J_regressor, reshape<2>(t, {v, 3 * columns})), {3 * j, columns});
    };
    const auto mean = reshape<2>(regress(reshape<2>(v_template, {3 * v, 1}), 1), {1, 3 * j});
    return matmul(betas, regress(shapedirs, k), {.transpose_b = true}) + mean;
  }

  /// betas (N, K), rotations (N, J, 9) local and row by row, translation (N, 3).
  PosedBody<B> operator()(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations,
                          const Tensor<B, 2>& translation) const {
    const Index n = rotations.size(0), j = joints(), v = vertices();
    if (rotations.shape() != Shape{n, j, 9} || betas.shape() != Shape{n, shapedirs.size(1)} ||
        translation.shape() != Shape{n, 3}) {
      raise<shape_error>(204, "BodyModel: betas ", betas.shape(), ", rotations ", rotations.shape(), ", translation ",
                         translation.shape(), " for ", j, " joints and ", shapedirs.size(1), " shape coefficients");
    }
    const auto rest = rest_joints(betas);
    const Chain chain = posed_chain(rest, rotations);

    const auto feature = reshape<2>(slice(rotations, 1, 1, j) - identity_row(), {n, 9 * (j - 1)});
    const auto shaped = matmul(betas, shapedirs, {.transpose_b = true}) + reshape<2>(v_template, {1, 3 * v});
    const auto posed = reshape<3>(shaped + matmul(feature, posedirs, {.transpose_b = true}), {n, v, 3});

    // Transform of every vertex: (V, J) (J, N 12) -> (V, N, 12)
    const auto transforms = permute(chain.skinning, {1, 0, 2});  // (J, N, 12)
    const auto blended =
        permute(reshape<3>(matmul(weights, reshape<2>(transforms, {j, n * 12})), {v, n, 12}), {1, 0, 2});
    std::vector<Tensor<B, 3>> axes;
    for (Index row = 0; row < 3; ++row) {
      auto entry = [&](Index column) { return slice(blended, 2, 4 * row + column, 4 * row + column + 1); };
      axes.push_back(entry(0) * slice(posed, 2, 0, 1) + entry(1) * slice(posed, 2, 1, 2) +
                     entry(2) * slice(posed, 2, 2, 3) + entry(3));
    }
    const auto tau = reshape<3>(translation, {n, 1, 3});
    PosedBody<B> out;
    out.vertices = concat(std::span<const Tensor<B, 3>>(axes), 2) + tau;
    out.joints = chain.positions + tau;
    if (!extra.empty()) out.extra = permute(gather(permute(out.vertices, {1, 0, 2}), extra), {1, 0, 2});
    return out;
  }

  /// Joints only: no vertex is touched. (N, J, 3)
  Tensor<B, 3> posed_joints(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations,
                            const Tensor<B, 2>& translation) const {
    return posed_chain(rest_joints(betas), rotations).positions + reshape<3>(translation, {translation.size(0), 1, 3});
  }

 private:
  struct Chain {
    Tensor<B, 3> positions;  // (N, J, 3)
    Tensor<B, 3> skinning;   // (N, J, 12): [R | t - R J], row by row
  };
  static Tensor<B, 1> identity_row() {
    return Tensor<B, 1>::from(std::vector<typename B::scalar>{1, 0, 0, 0, 1, 0, 0, 0, 1}, {9});
  }
  /// The chain, one joint after the other, all poses at once: every number is a tensor (N, 1).
  Chain posed_chain(const Tensor<B, 2>& rest, const Tensor<B, 3>& rotations) const {
    using S = Tensor<B, 2>;
    const Index n = rotations.size(0);
    auto rest_of = [&](std::size_t j) {
      auto c = [&](Index axis) {
        return slice(rest, 1, 3 * static_cast<Index>(j) + axis, 3 * static_cast<Index>(j) + axis + 1);
      };
      return Vec3<S>{c(0), c(1), c(2)};
    };
    std::vector<Matrix3<S>> rotation(parents.size());
    std::vector<Vec3<S>> position(parents.size());
    std::vector<S> points, transforms;
    for (std::size_t j = 0; j < parents.size(); ++j) {
      const auto flat = reshape<2>(slice(rotations, 1, static_cast<Index>(j), static_cast<Index>(j) + 1), {n, 9});
      Matrix3<S> local;
      for (Index i = 0; i < 9; ++i) local.m[static_cast<std::size_t>(i)] = slice(flat, 1, i, i + 1);
      const Vec3<S> own = rest_of(j);
      if (parents[j] < 0) {
        rotation[j] = local;
        position[j] = own;
      } else {
        const auto p = static_cast<std::size_t>(parents[j]);
        rotation[j] = rotation[p] * local;
        position[j] = position[p] + rotation[p] * (own - rest_of(p));
      }
      const Vec3<S> shift = position[j] - rotation[j] * own;
      points.insert(points.end(), {position[j].x, position[j].y, position[j].z});
      const std::array<S, 3> t{shift.x, shift.y, shift.z};
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) transforms.push_back(rotation[j](row, column));
        transforms.push_back(t[static_cast<std::size_t>(row)]);
      }
    }
    return {reshape<3>(concat(std::span<const S>(points), 1), {n, joints(), 3}),
            reshape<3>(concat(std::span<const S>(transforms), 1), {n, joints(), 12})};
  }
};

}  // namespace motionlang::inline MOTIONLANG_ABI
