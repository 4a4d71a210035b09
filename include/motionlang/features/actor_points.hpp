// SPDX-License-Identifier: MIT
/// ACTOR's motions on an SMPL body: from rotations to the points that its loss compares and its metrics read.
///
///     vertices  the surface, where SMPL puts it      a2m    18 joints of Action2Motion    vibe  49 joints of VIBE
///     smpl      24 joints                            a2mpl  28: both together
/// Source  thesis 3.2.2, "vertex coordinates"; ACTOR src/models/rotation2xyz.py and src/models/smpl.py
#pragma once

#include <motionlang/features/pose_representation.hpp>
#include <motionlang/kinematics/body_model.hpp>
#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

enum class ActorPoints : int { vertices, smpl, a2m, a2mpl, vibe };
inline constexpr std::array<std::string_view, 5> actor_point_names{"vertices", "smpl", "a2m", "a2mpl", "vibe"};

/// Throws config_error 103.
ActorPoints parse_actor_points(std::string_view name);

/// Numbers of the points among 54: the 24 joints of SMPL, the 21 vertices of `body_points`, and 9 that a regressor
/// computes from the surface. None for vertices.
std::span<const Index> actor_point_numbers(ActorPoints points);

struct ActorPointOptions {
  ActorFeatureOptions features{};  // the features of the motions
  bool translate = true;           // "vertstrans": moved by the path since the first frame, if the features have one
  Vec3<double> global_rotation = actor_global_rotation;  // of joint 0 if the features have none: a rotation vector
  double second_beta = 0;                                // the second coefficient of the shape; the others are 0
};

namespace detail {

/// All 54 points, (frames, 54, 3).
template <Backend B>
Tensor<B, 3> actor_54_points(const PosedBody<B>& posed, const Tensor<B, 2>* J_regressor_extra) {
  const Index frames = posed.vertices.size(0), v = posed.vertices.size(1);
  if (J_regressor_extra == nullptr || J_regressor_extra->shape() != Shape{9, v} || posed.extra.count() != 63 * frames ||
      posed.joints.size(1) != 24) {
    raise<shape_error>(204, "actor_points: a body of ", posed.joints.size(1), " joints and ", v,
                       " vertices needs 24 joints, 21 picked vertices and a regressor (9, ", v, ")");
  }
  const auto surface = reshape<2>(permute(posed.vertices, {1, 0, 2}), {v, 3 * frames});
  const auto regressed = permute(reshape<3>(matmul(*J_regressor_extra, surface), {9, frames, 3}), {1, 0, 2});
  return concat(1, posed.joints, posed.extra, regressed);
}

}  // namespace detail

/// x: frames of `actor_frame_features`, (frames, rows numbers) -> (frames, 3 points). All points except vertices are
/// relative to the root of their frame. J_regressor_extra (9, vertices) may be null for vertices and smpl.
/// Differentiable.
/// Throws  shape_error 204 if motion, body and point set do not fit, config_error 101 for a second coefficient that the
///         body lacks
template <Backend B>
Sequences<B> actor_points(const Sequences<B>& x, const BodyModel<B>& body, const Tensor<B, 2>* J_regressor_extra,
                          ActorPoints points, const ActorPointOptions& o = {}) {
  using S = typename B::scalar;
  const PoseRepresentation form = o.features.rotations;
  const Index frames = x.offsets.rows(), joints = body.joints(), numbers = size(form);
  const Index own = o.features.global ? joints : joints - 1, first_of_way = own * numbers;
  if (x.width() != first_of_way + (o.features.translation ? numbers : 0)) {
    raise<shape_error>(204, "actor_points: frames of ", x.width(), " numbers for ", own, " rotations of ", numbers,
                       o.features.translation ? " and a translation" : "");
  }
  auto rotations = rotation_rows(reshape<3>(slice(x.rows, 1, 0, first_of_way), {frames, own, numbers}),
                                 [form](const auto& n) { return rotation_from(form, n); });
  if (!o.features.global) {
    const auto m = matrix_cast<S>(to_matrix(AxisAngle{o.global_rotation})).m;
    const auto global = Tensor<B, 3>::from(std::vector<S>(m.begin(), m.end()), {1, 1, 9});
    rotations = concat(1, broadcast_to<3>(global, {frames, 1, 9}), rotations);
  }
  std::vector<S> shape(static_cast<std::size_t>(body.shapedirs.size(1)));
  if (shape.size() > 1)
    shape[1] = static_cast<S>(o.second_beta);
  else if (o.second_beta != 0)
    raise<config_error>(101, "actor_points: a body of ", shape.size(), " shape coefficients has no second one");
  const Index coefficients = std::ssize(shape);
  const auto betas = broadcast_to<2>(Tensor<B, 2>::from(shape, {1, coefficients}), {frames, coefficients});
  const auto nowhere = Tensor<B, 2>::zeros({frames, 3});
  Tensor<B, 3> out;
  if (points == ActorPoints::smpl) {
    out = body.posed_joints(betas, rotations, nowhere);
  } else {
    const auto posed = body(betas, rotations, nowhere);
    out = points == ActorPoints::vertices
              ? posed.vertices
              : permute(gather(permute(detail::actor_54_points(posed, J_regressor_extra), {1, 0, 2}),
                               actor_point_numbers(points)),
                        {1, 0, 2});
  }
  if (points != ActorPoints::vertices) {
    const Index root = points == ActorPoints::vibe ? 8 : 0;
    out = out - slice(out, 1, root, root + 1);
  }
  if (o.features.translation && o.translate) {
    PoolVector<Index> first;
    for (Index s : sequence_of_row(x.offsets)) first.push_back(x.offsets.begin(s));
    const auto way = slice(x.rows, 1, first_of_way, first_of_way + 3);
    out = out + reshape<3>(way - gather(way, first), {frames, 1, 3});
  }
  return x.with(reshape<2>(out, {frames, 3 * out.size(1)}));
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/features/actor_points.ipp>
#endif
