// SPDX-License-Identifier: MIT
/// Linear blend skinning with shape and pose blend shapes: the forward pass of SMPL, SMPL-H and SMPL-X, over any
/// backend.
///
/// On a bare backend, every lane of a register holds another pose (Lane). All threads take blocks of vertices, compute
/// their blend shapes and skin them while they are in the cache. (`prepare` the model first, so that its blend shapes
/// are packed once.) On an Autodiff backend, every value of the chain is a tensor over the poses. So vertices and
/// joints can be differentiated by shape, rotations and translation.
///
/// Source    Loper et al. (2015), eq. 2-12; vchoutas/smplx smplx/lbs.py. The model's arrays come from the user's own
///           file (formats/body_file.hpp) or from a skeleton (formats/figure_body.hpp).
/// Notation  V vertices, J joints, K shape coefficients, N poses; beta -> betas, R_j -> rotations, tau -> translation
/// Differs   from the smplx package: rest joints come from a regressor that is folded into template and shape
///           directions. This is the same sum in another order
#pragma once

#include <memory>  // what is packed

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/core/fields.hpp>
#include <motionlang/core/lane_rows.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/kinematics/forward.hpp>
#include <motionlang/kinematics/skinning.hpp>
#include <motionlang/tensor/fused.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/module.hpp>
#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Posed points. vertices (N, V, 3), joints (N, J, 3), extra (N, E, 3): selected vertices.
template <Backend B>
struct PosedBody {
  Tensor<B, 3> vertices, joints, extra;
};

namespace detail {

/// The kinematic chain, joint after joint. rest(j) and local(j) give a joint's rest position and rotation;
/// put(j, R, p, t) takes its world rotation, its position, and t = p - R rest(j), which skinning needs.
template <class S, class Rest, class Local, class Put>
void walk_chain(std::span<const int> parents, JointTransforms<S>& world, Rest rest, Local local, Put put) {
  world.rotation.resize(parents.size());
  world.position.resize(parents.size());
  for (std::size_t j = 0; j < parents.size(); ++j) {
    const Vec3<S> own = rest(j);
    if (parents[j] < 0) {
      world.rotation[j] = local(j);
      world.position[j] = own;
    } else {
      const auto p = static_cast<std::size_t>(parents[j]);
      world.rotation[j] = world.rotation[p] * local(j);
      world.position[j] = world.position[p] + world.rotation[p] * (own - rest(p));
    }
    put(j, world.rotation[j], world.position[j], world.position[j] - world.rotation[j] * own);
  }
}

}  // namespace detail

/// Converts rotations of F values each, (N, J, F), to the matrices that a body model takes: (N, J, 9), row by row.
/// matrix_of makes a Matrix3 from a span of F values. On an Autodiff backend a value is a tensor over all rotations.
template <Backend B, class F>
Tensor<B, 3> rotation_rows(const Tensor<B, 3>& rotations, F matrix_of) {
  const Index n = rotations.size(0), j = rotations.size(1), width = rotations.size(2);
  if constexpr (AutodiffBackend<B>) {
    const auto flat = reshape<2>(rotations, {n * j, width});
    std::vector<Tensor<B, 2>> numbers;
    for (Index c = 0; c < width; ++c) numbers.push_back(slice(flat, 1, c, c + 1));
    const auto m = matrix_of(std::span<const Tensor<B, 2>>(numbers)).m;
    return reshape<3>(concat(std::span<const Tensor<B, 2>>(m), 1), {n, j, 9});
  } else {
    using S = typename B::scalar;
    const std::span<const S> from = rotations.span();
    return Tensor<B, 3>::written({n, j, 9}, [&](S* to) {
      parallel_for(n, [&](Index pose) {
        for (Index i = pose * j; i < (pose + 1) * j; ++i) {
          const auto m =
              matrix_of(from.subspan(static_cast<std::size_t>(i * width), static_cast<std::size_t>(width))).m;
          std::copy_n(m.begin(), 9, to + 9 * i);
        }
      });
    });
  }
}
/// The same for rotation vectors (N, J, 3). Differentiable, also at 0.
template <Backend B>
Tensor<B, 3> rotation_rows(const Tensor<B, 3>& axis_angles) {
  return rotation_rows(axis_angles, [](const auto& v) { return to_matrix(AxisAngle{Vec3{v[0], v[1], v[2]}}); });
}

template <Backend B>
struct BodyModel {
  static constexpr bool trainable = false;
  Tensor<B, 2> v_template;   // (V, 3)
  Tensor<B, 2> shapedirs;    // (3 V, K); K may be 0
  Tensor<B, 2> posedirs;     // (3 V, 9 (J - 1)), or (3 V, 0): no pose blend shapes
  Tensor<B, 2> J_regressor;  // (J, V)
  Tensor<B, 2> weights;      // (V, J)
  std::vector<int> parents;  // -1 for the root
  std::vector<Index> extra;  // vertex numbers of the extra joints

  /// Rest positions of the joints as a linear function of betas.
  struct RestJoints {
    Tensor<B, 1> mean;        // (3 J)
    Tensor<B, 2> directions;  // (3 J, K)
  };
  /// Blend shapes in packed blocks of vertices, the nonzero weights, and the regressor folded into template and shape
  /// directions.
  struct Surface {
    struct Block {
      Index first, last;
      Tensor<B, 2> directions;
      Tensor<B, 1> mean;
    };
    std::vector<Block> blocks;
    SkinWeights<typename B::scalar> weights;
    RestJoints rest;
  };
  // Made by `prepare`. After that the tensors must not change, nor those of copies.
  std::shared_ptr<const Surface> packed{};

  static constexpr auto fields() {
    using M = BodyModel;
    return motionlang::fields("v_template", &M::v_template, "shapedirs", &M::shapedirs, "posedirs", &M::posedirs,
                              "J_regressor", &M::J_regressor, "weights", &M::weights, "parents", &M::parents, "extra",
                              &M::extra);
  }

  Index vertices() const { return v_template.size(0); }
  Index joints() const { return static_cast<Index>(parents.size()); }

  /// Throws shape_error 204 if the arrays do not fit together, config_error 106 if a parent does not come before its
  /// child, and 101 for an extra joint without a vertex.
  void validate() const {
    const Index v = vertices(), j = joints();
    const bool blends = posedirs.shape() == Shape{3 * v, 9 * (j - 1)} || posedirs.shape() == Shape{3 * v, 0};
    if (shapedirs.size(0) != 3 * v || !blends || J_regressor.shape() != Shape{j, v} || weights.shape() != Shape{v, j}) {
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
    const RestJoints rest = packed ? packed->rest : regressed();
    return blended(betas, rest.directions, rest.mean);
  }

  /// betas (N, K), rotations (N, J, 9) local and row by row, translation (N, 3).
  PosedBody<B> operator()(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations,
                          const Tensor<B, 2>& translation) const {
    check(betas, rotations, translation);
    const auto rest = rest_joints(betas);
    const auto coefficients = blend_coefficients(betas, rotations);
    PosedBody<B> out;
    if constexpr (AutodiffBackend<B>) {
      const Chain chain = posed_chain(rest, rotations);
      const auto tau = reshape<3>(translation, {translation.size(0), 1, 3});
      out.vertices =
          skinned(blended(coefficients, directions(0, vertices()), mean(0, vertices())), chain.transforms) + tau;
      out.joints = chain.positions + tau;
    } else {
      const detail::BufferHandle transforms(skin_transform_bytes<S>(rotations.size(0), joints()));
      out.joints = posed_joints(rest, rotations, translation, static_cast<S*>(transforms.data()));
      out.vertices = surface(coefficients, static_cast<const S*>(transforms.data()));
    }
    if (!extra.empty()) out.extra = permute(gather(permute(out.vertices, {1, 0, 2}), extra), {1, 0, 2});
    return out;
  }

  /// The work of `prepare`: packs blend shapes in blocks of vertices. Does nothing on an Autodiff backend.
  void pack_surface() {
    if constexpr (!AutodiffBackend<B>) {
      Surface made = empty_surface();
      made.rest = regressed();
      for (Index i = 0; i < blocks(); ++i) {
        made.blocks.push_back(block(i));
        if constexpr (PackingBackend<B>) B::prepare(made.blocks.back().directions.data());
      }
      packed = std::make_shared<const Surface>(std::move(made));
    }
  }

  /// Joints only: vertices are not computed. (N, J, 3)
  Tensor<B, 3> posed_joints(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations,
                            const Tensor<B, 2>& translation) const {
    check(betas, rotations, translation);
    if constexpr (AutodiffBackend<B>) {
      return posed_chain(rest_joints(betas), rotations).positions +
             reshape<3>(translation, {translation.size(0), 1, 3});
    } else {
      return posed_joints(rest_joints(betas), rotations, translation, nullptr);
    }
  }

 private:
  using S = typename B::scalar;
  struct Chain {
    Tensor<B, 3> positions;   // (N, J, 3)
    Tensor<B, 3> transforms;  // [R | p - R rest], (N, J, 12) row by row
  };

  void check(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations, const Tensor<B, 2>& translation) const {
    const Index n = rotations.size(0), j = joints();
    if (rotations.shape() != Shape{n, j, 9} || betas.shape() != Shape{n, shapedirs.size(1)} ||
        translation.shape() != Shape{n, 3}) {
      raise<shape_error>(204, "BodyModel: betas ", betas.shape(), ", rotations ", rotations.shape(), ", translation ",
                         translation.shape(), " for ", j, " joints and ", shapedirs.size(1), " shape coefficients");
    }
  }
  static Tensor<B, 1> identity_row() { return Tensor<B, 1>::from(std::vector<S>{1, 0, 0, 0, 1, 0, 0, 0, 1}, {9}); }

  RestJoints regressed() const {
    const Index v = vertices(), j = joints(), k = shapedirs.size(1);
    auto regress = [&](const Tensor<B, 2>& t, Index columns) {
      return matmul(J_regressor, reshape<2>(t, {v, 3 * columns}));
    };
    return {reshape<1>(regress(v_template, 1), {3 * j}), reshape<2>(regress(shapedirs, k), {3 * j, k})};
  }
  /// Factors of the shape directions and, if there are any, of the pose directions: (N, K + 9 (J - 1)).
  Tensor<B, 2> blend_coefficients(const Tensor<B, 2>& betas, const Tensor<B, 3>& rotations) const {
    if (posedirs.size(1) == 0) return betas;
    const Index n = rotations.size(0), j = joints();
    return concat(1, betas, reshape<2>(slice(rotations, 1, 1, j) - identity_row(), {n, 9 * (j - 1)}));
  }
  /// A copy of both directions side by side, for vertices first ... last - 1: (3 (last - first), K + 9 (J - 1)).
  Tensor<B, 2> directions(Index first, Index last) const {
    return concat(1, slice(shapedirs, 0, 3 * first, 3 * last), slice(posedirs, 0, 3 * first, 3 * last));
  }
  Tensor<B, 1> mean(Index first, Index last) const {
    return reshape<1>(slice(v_template, 0, first, last), {3 * (last - first)});
  }
  /// Points of the rest pose with blend shapes: vertices, (N, 3 vertices), or joints.
  static Tensor<B, 2> blended(const Tensor<B, 2>& coefficients, const Tensor<B, 2>& directions,
                              const Tensor<B, 1>& mean) {
    if (coefficients.size(1) == 0)
      return reshape<2>(mean, {1, mean.size(0)}) + Tensor<B, 2>::zeros({coefficients.size(0), 1});
    return linear(coefficients, directions, &mean);
  }

  // A block of vertices and a block of poses, with the directions between them, fit into the second-level cache. SMPL
  // has 54 blocks of vertices, which threads share evenly.
  static constexpr Index block_vertices = 128, block_poses = 256;
  Index blocks() const { return (vertices() + block_vertices - 1) / block_vertices; }
  typename Surface::Block block(Index i) const {
    const Index first = i * block_vertices, last = std::min(vertices(), first + block_vertices);
    return {first, last, directions(first, last), mean(first, last)};
  }
  Surface empty_surface() const { return {.blocks = {}, .weights = SkinWeights(weights.span(), joints()), .rest = {}}; }

  /// The vertices of all poses, (N, V, 3), from the output of posed_joints.
  Tensor<B, 3> surface(const Tensor<B, 2>& coefficients, const S* transforms) const {
    const std::shared_ptr<const Surface> made = packed ? packed : std::make_shared<const Surface>(empty_surface());
    const Index n = coefficients.size(0);
    return Tensor<B, 3>::written({n, vertices(), 3}, [&](S* to) {
      parallel_for(blocks() * ((n + block_poses - 1) / block_poses), [&](Index task) {
        const Index i = task % blocks(), top = task / blocks() * block_poses, end = std::min(n, top + block_poses);
        const auto b = packed ? made->blocks[static_cast<std::size_t>(i)] : block(i);
        const auto posed = blended(slice(coefficients, 0, top, end), b.directions, b.mean);
        const S* const from = posed.span().data();
        with_widest_lanes<S>([&]<class L>() {
          for (Index first = top; first < end; first += L::size) {
            const auto own = reinterpret_cast<const L*>(transforms + first * joints() * skin_transform_size);
            skin_vertices(made->weights, b.first, b.last, from + (first - top) * 3 * (b.last - b.first), own,
                          static_cast<int>(std::min<Index>(L::size, end - first)), to + first * 3 * vertices());
          }
        });
      });
    });
  }

  /// All poses at once: every value is a tensor (N, 1).
  Chain posed_chain(const Tensor<B, 2>& rest, const Tensor<B, 3>& rotations) const {
    using T = Tensor<B, 2>;
    const Index n = rotations.size(0);
    JointTransforms<T> world;
    std::vector<T> points, transforms;
    detail::walk_chain(
        std::span(parents), world,
        [&](std::size_t j) {
          auto c = [&](Index axis) {
            return slice(rest, 1, 3 * static_cast<Index>(j) + axis, 3 * static_cast<Index>(j) + axis + 1);
          };
          return Vec3<T>{c(0), c(1), c(2)};
        },
        [&](std::size_t j) {
          const auto flat = reshape<2>(slice(rotations, 1, static_cast<Index>(j), static_cast<Index>(j) + 1), {n, 9});
          Matrix3<T> local;
          for (Index i = 0; i < 9; ++i) local.m[static_cast<std::size_t>(i)] = slice(flat, 1, i, i + 1);
          return local;
        },
        [&](std::size_t, const Matrix3<T>& r, const Vec3<T>& p, const Vec3<T>& t) {
          points.insert(points.end(), {p.x, p.y, p.z});
          transforms.insert(transforms.end(),
                            {r.m[0], r.m[1], r.m[2], t.x, r.m[3], r.m[4], r.m[5], t.y, r.m[6], r.m[7], r.m[8], t.z});
        });
    return {reshape<3>(concat(std::span<const T>(points), 1), {n, joints(), 3}),
            reshape<3>(concat(std::span<const T>(transforms), 1), {n, joints(), 12})};
  }

  /// (N, V, 3) from the vertices before skinning, (N, 3 V), and the joints' transforms, (N, J, 12).
  Tensor<B, 3> skinned(const Tensor<B, 2>& before, const Tensor<B, 3>& transforms) const {
    const Index n = before.size(0), j = joints(), v = vertices();
    const auto posed = reshape<3>(before, {n, v, 3});
    // Transform of every vertex: (V, J) (J, N 12) -> (N, V, 12)
    const auto by_joint = reshape<2>(permute(transforms, {1, 0, 2}), {j, n * 12});
    const auto blended = permute(reshape<3>(matmul(weights, by_joint), {v, n, 12}), {1, 0, 2});
    std::vector<Tensor<B, 3>> axes;
    for (Index row = 0; row < 3; ++row) {
      auto entry = [&](Index column) { return slice(blended, 2, 4 * row + column, 4 * row + column + 1); };
      axes.push_back(entry(0) * slice(posed, 2, 0, 1) + entry(1) * slice(posed, 2, 1, 2) +
                     entry(2) * slice(posed, 2, 2, 3) + entry(3));
    }
    return concat(std::span<const Tensor<B, 3>>(axes), 2);
  }

  /// The joints (N, J, 3), moved by the translation. Unless `transforms` is null, also writes the transforms for
  /// skin_vertices, (groups of poses, J, 12, lanes).
  Tensor<B, 3> posed_joints(const Tensor<B, 2>& rest, const Tensor<B, 3>& rotations, const Tensor<B, 2>& translation,
                            S* transforms) const {
    const Index n = rotations.size(0);
    const auto j = parents.size();
    const S *rest_at = rest.span().data(), *rotation_at = rotations.span().data(), *tau_at = translation.span().data();
    return Tensor<B, 3>::written({n, joints(), 3}, [&](S* positions) {
      constexpr Index block = 64;  // poses for a thread at a time: whole groups for any number of lanes
      parallel_for((n + block - 1) / block, [&](Index part) {
        with_widest_lanes<S>([&]<class L>() {
          JointTransforms<L> world;
          std::vector<Vec3<L>> own(j), moved(j);
          std::vector<Matrix3<L>> local(j);
          Vec3<L> tau;
          for (Index top = part * block; top < std::min(n, (part + 1) * block); top += L::size) {
            const int poses = static_cast<int>(std::min<Index>(L::size, n - top));
            const auto all = static_cast<std::size_t>(top);
            load_rows(rest_at + all * 3 * j, 3 * j, poses, std::span<L>(&own[0].x, 3 * j));
            load_rows(rotation_at + all * 9 * j, 9 * j, poses, std::span<L>(local[0].m.data(), 9 * j));
            load_rows(tau_at + all * 3, 3, poses, std::span<L>(&tau.x, 3));
            L* to = transforms == nullptr ? nullptr : reinterpret_cast<L*>(transforms + all * j * skin_transform_size);
            detail::walk_chain(
                std::span(parents), world, [&](std::size_t i) { return own[i]; },
                [&](std::size_t i) { return local[i]; },
                [&](std::size_t i, const Matrix3<L>& r, const Vec3<L>& p, const Vec3<L>& t) {
                  moved[i] = p + tau;
                  if (to == nullptr) return;
                  for (const L& x : {r.m[0], r.m[1], r.m[2], t.x + tau.x, r.m[3], r.m[4], r.m[5], t.y + tau.y, r.m[6],
                                     r.m[7], r.m[8], t.z + tau.z}) {
                    ::new (static_cast<void*>(to++)) L(x);
                  }
                });
            store_rows(std::span<const L>(&moved[0].x, 3 * j), 3 * j, poses, positions + all * 3 * j);
          }
        });
      });
    });
  }
};

/// Prepares a body for use. The model must not change afterwards.
template <Backend B>
void prepare(BodyModel<B>& model) {
  model.pack_surface();
}

MOTIONLANG_NAMESPACE_END
