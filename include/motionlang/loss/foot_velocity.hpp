// SPDX-License-Identifier: MIT
/// A loss on the velocity of the feet, which keeps them from sliding under the figure.
///
///     const auto loss = foot_velocity_loss<A>(normaliser.denormalize(out), truth, offsets, 20);
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <motionlang/features/smplrifke.hpp>
#include <motionlang/kinematics/forward_batch.hpp>
#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Pelvis and legs of SMPL's skeleton; the last four joints, ankles and toes, are the feet.
inline constexpr std::array leg_joints{0, 1, 2, 4, 5, 7, 8, 10, 11};
inline constexpr Index foot_values = 12;  // four joints, x y z

inline const Skeleton& leg_skeleton() {
  static const Skeleton skeleton = [] {
    Skeleton legs;
    for (const int j : leg_joints) {
      const auto at = static_cast<std::size_t>(j);
      const auto parent = std::find(leg_joints.begin(), leg_joints.end(), smpl24_skeleton().parents[at]);
      legs.names.push_back(smpl24_skeleton().names[at]);
      legs.parents.push_back(j == 0 ? -1 : static_cast<int>(parent - leg_joints.begin()));
      legs.offsets.push_back(smpl24_skeleton().offsets[at]);
    }
    return legs;
  }();
  return skeleton;
}

/// Ankles and toes relative to the pelvis, seen from the body, by the rotations in 205-vectors.
/// (rows, 205) -> (rows, 12)
template <Backend B>
Tensor<B, 2> feet_of(const Tensor<B, 2>& features) {
  const Index rows = features.size(0), joints = std::ssize(leg_joints);
  std::vector<Tensor<B, 2>> rotations;
  for (const int j : leg_joints) rotations.push_back(slice(features, 1, 4 + 6 * j, 10 + 6 * j));
  const auto rot6d = reshape<4>(concat(std::span<const Tensor<B, 2>>(rotations), 1), {1, rows, joints, 6});
  const auto places = forward_kinematics(leg_skeleton(), lanes(rot6d, Tensor<B, 3>::zeros({1, rows, 3})));
  return reshape<2>(slice(places, 2, joints - foot_values / 3, joints), {rows, foot_values});
}

}  // namespace detail

/// Mean square of the error of the feet's velocity in the world, in (m/s)^2.
///     V = (v + Rz(turn) p' - p, z' + p'_z - z - p_z),   p: foot, p': in the next frame, v: the root's velocity
/// To first order in the error of `turn`.
/// Shapes   features, truth (rows, 205), not normalised: sequences one after another, by `offsets` -> ()
/// Source   the geometric losses of MDM (Tevet et al. 2023, eq. 4 and 5)
/// Differs  from these: the path of the root is part of the velocity. Feet that move at less than 0.4 m/s over the
///          floor in `truth`, as standing feet do, count five times.
template <AutodiffBackend A>
Tensor<A, 0> foot_velocity_loss(const Tensor<A, 2>& features, const Tensor<typename A::inner, 2>& truth,
                                const Offsets& offsets, double fps) {
  using B = typename A::inner;
  using S = typename B::scalar;
  std::vector<Index> now, next;
  for (Index s = 0; s < offsets.count(); ++s)
    for (Index r = offsets.begin(s); r + 1 < offsets.end(s); ++r) now.push_back(r), next.push_back(r + 1);

  // The true movement of the feet, and the weight of each value.
  const auto true_feet = detail::feet_of(truth);
  const auto feet = true_feet.span(), root = truth.span();
  std::vector<S> lever, weight;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const auto* r = root.data() + now[i] * smplrifke_size;
    for (Index k = 0; k < detail::foot_values; k += 3) {
      const auto *p = feet.data() + now[i] * detail::foot_values + k,
                 *q = feet.data() + next[i] * detail::foot_values + k;
      const S vx = r[1] + q[0] - r[3] * q[1] - p[0], vy = r[2] + q[1] + r[3] * q[0] - p[1];
      const S w = std::hypot(vx, vy) * static_cast<S>(fps) < S(0.4) ? std::sqrt(S(5)) : S(1);
      lever.insert(lever.end(), {-q[1], q[0], S(0)});
      weight.insert(weight.end(), {w, w, w});
    }
  }
  const Shape shape{std::ssize(now), detail::foot_values};

  // Maps columns of the root's error to the twelve values.
  std::vector<S> here(4 * detail::foot_values), there(4 * detail::foot_values), turn(4 * detail::foot_values);
  for (std::size_t k = 0; k < detail::foot_values; k += 3) {
    here[1 * detail::foot_values + k] = here[2 * detail::foot_values + k + 1] = 1;
    here[k + 2] = -1, there[k + 2] = 1;
    for (std::size_t c = 0; c < 3; ++c) turn[3 * detail::foot_values + k + c] = 1;
  }
  auto constant = [](const std::vector<S>& values, const Shape& s) { return Tensor<A, 2>::from(values, s); };
  const Shape four{4, detail::foot_values};
  const auto error = detail::feet_of(features) - Tensor<A, 2>::from(feet, true_feet.shape());
  const auto root_error = slice(features, 1, 0, 4) - slice(Tensor<A, 2>::from(root, truth.shape()), 1, 0, 4);
  const auto root_now = gather(root_error, now);
  const auto velocity = gather(error, next) - gather(error, now) + matmul(root_now, constant(here, four)) +
                        matmul(gather(root_error, next), constant(there, four)) +
                        matmul(root_now, constant(turn, four)) * constant(lever, shape);
  return mean(square(velocity * constant(weight, shape))) * (fps * fps);
}

MOTIONLANG_NAMESPACE_END
