// SPDX-License-Identifier: MIT
/// From rotations to the joints that TEMOS, TEACH and SINC compare: an SMPL-H body and a set of joints.
#pragma once

#include <motionlang/features/joint_sets.hpp>
#include <motionlang/kinematics/body.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One sequence on a body of shape 0. name: a set of joint_sets.hpp, or "vertices".
/// rotations    (frames, 22 or 52, 9), row by row; with 22 the hands stay in their mean pose
/// translation  (frames, 3)
/// result       (frames, points, 3)
/// Source       thesis 4.3.5, table 4.10; TEMOS temos/transforms/rots2joints/smplh.py
/// Throws       config_error 103 for an unknown name, 106, shape_error 204, 205
template <Backend B>
Tensor<B, 3> smplh_joints(std::string_view name, const Body<B>& body, const Tensor<B, 3>& rotations,
                          const Tensor<B, 2>& translation) {
  using S = typename B::scalar;
  const Index frames = rotations.size(0);
  const auto posed = body.model(Tensor<B, 2>::zeros({frames, body.model.shapedirs.size(1)}),
                                with_mean_hands(body, rotations), translation);
  if (name == "vertices") return posed.vertices;
  auto vectors = [](std::span<const S> numbers) {
    std::vector<Vec3<S>> out;
    for (std::size_t i = 0; i < numbers.size(); i += 3) out.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
    return out;
  };
  const auto joints_and_extra = concat(1, posed.joints, posed.extra);
  const auto points = vectors(joints_and_extra.span()), trans = vectors(translation.span());
  const auto joints = select_joints<S>(name, points, trans);
  std::vector<S> out;
  for (const auto& p : joints) out.insert(out.end(), {p.x, p.y, p.z});
  return Tensor<B, 3>::from(out, {frames, std::ssize(joints) / std::max<Index>(frames, 1), 3});
}

MOTIONLANG_NAMESPACE_END
