// SPDX-License-Identifier: MIT
/// Forward kinematics of a whole batch: the function of forward.hpp for many poses at once.
///
///     auto joints = forward_kinematics(skeleton, lanes(rot6d, root));     // (batch, time, joints, 3)
///
/// On a bare backend, all threads compute as many poses at a time as SIMD registers hold (Lane). On an Autodiff backend
/// every value is a tensor over batch and time, so the result can be differentiated.
#pragma once

#include <algorithm>    // min
#include <type_traits>  // which path
#include <vector>       // joints of a register

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/core/lane_rows.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/geometry/rotation6d.hpp>
#include <motionlang/kinematics/forward.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Poses of a batch: rotations as their first two rows, and root positions.
template <Backend B>
struct LanePoses {
  Tensor<B, 4> rot6d;  // (batch, time, joints, 6)
  Tensor<B, 3> root;   // (batch, time, 3)
};
/// Throws shape_error 204 if the two do not fit.
template <Backend B>
LanePoses<B> lanes(Tensor<B, 4> rot6d, Tensor<B, 3> root) {
  if (rot6d.size(3) != 6 || root.shape() != Shape{rot6d.size(0), rot6d.size(1), 3}) {
    raise<shape_error>(204, "lanes: rotations ", rot6d.shape(), ", root ", root.shape());
  }
  return {std::move(rot6d), std::move(root)};
}

namespace detail {

/// Poses in plain arrays, processed in groups of as many as there are lanes.
template <Scalar S>
class PoseArrays {
 public:
  PoseArrays(const Skeleton& skeleton, const S* rot6d, const S* root, Index count, S* joints)
      : skeleton_(skeleton),
        has_children_(static_cast<std::size_t>(skeleton.size())),
        rot6d_(rot6d),
        root_(root),
        count_(count),
        joints_(joints) {
    for (const int parent : skeleton.parents) {
      if (parent >= 0) has_children_[static_cast<std::size_t>(parent)] = true;
    }
  }

  /// Poses first ... last - 1.
  template <class L>
  void place(Index first, Index last) const {
    const auto n = static_cast<std::size_t>(skeleton_.size());
    JointTransforms<L> world{std::vector<Vec3<L>>(n), std::vector<Matrix3<L>>(n)};
    for (; first < last; first += L::size) place_group(first, last, world);
  }

 private:
  /// Prefetches the values of the next group meanwhile, a few lines with every joint.
  template <class L>
  void place_group(Index first, Index last, JointTransforms<L>& world) const {
    const std::size_t n = has_children_.size();
    const int poses = static_cast<int>(std::min<Index>(L::size, last - first));
    const S* const from = rot6d_ + first * static_cast<Index>(6 * n);
    S* const to = joints_ + first * static_cast<Index>(3 * n);
    const bool more = first + 2 * L::size <= count_;
    Vec3<L> root;
    Rotation6dRows<L> local[2];  // twelve values: three fours, for load_rows
    static_assert(sizeof(local) == 12 * sizeof(L) && sizeof(root) == 3 * sizeof(L));
    load_rows(root_ + first * 3, 3, poses, std::span<L>(&root.x, 3));
    for (std::size_t j = 0; j < n; j += 2) {
      const std::size_t some = std::min<std::size_t>(2, n - j);
      load_rows(from + 6 * j, 6 * n, poses, std::span<L>(&local[0].a.x, 6 * some));
      if (more) {
        prefetch<0>(from + L::size * 6 * (n + j), L::size * 6 * some);
        prefetch<1>(to + L::size * 3 * (n + j), L::size * 3 * some);
      }
      for (std::size_t i = j; i < j + some; ++i) place_joint(skeleton_, i, local[i - j], root, has_children_[i], world);
    }
    store_rows(std::span<const L>(&world.position[0].x, 3 * n), 3 * n, poses, to);
  }

  template <int write>
  static void prefetch(const S* from, std::size_t count) {
    for (std::size_t i = 0; i < count; i += 64 / sizeof(S)) __builtin_prefetch(from + i, write);
  }

  const Skeleton& skeleton_;
  std::vector<char> has_children_;  // of every joint: a joint without children needs no rotation
  const S *rot6d_, *root_;
  Index count_;
  S* joints_;
};

}  // namespace detail

/// Plain arrays: rot6d (poses, joints, 6), root (poses, 3) -> joints (poses, joints, 3). Throws shape_error 205.
template <Scalar S>
void forward_kinematics(const Skeleton& skeleton, std::span<const S> rot6d, std::span<const S> root,
                        std::span<S> joints) {
  const Index n = skeleton.size(), poses = static_cast<Index>(root.size()) / 3;
  if (static_cast<Index>(rot6d.size()) != 6 * n * poses || static_cast<Index>(joints.size()) != 3 * n * poses ||
      root.size() % 3 != 0) {
    raise<shape_error>(205, "forward_kinematics: ", rot6d.size(), " rotation values, ", root.size(), " root values, ",
                       joints.size(), " joint values for ", n, " joints");
  }
  const detail::PoseArrays<S> arrays(skeleton, rot6d.data(), root.data(), poses, joints.data());
  constexpr Index block = 512;
  parallel_for((poses + block - 1) / block, [&](Index b) {
    with_widest_lanes<S>([&]<class L>() { arrays.template place<L>(b * block, std::min(poses, (b + 1) * block)); });
  });
}

/// -> (batch, time, joints, 3). Throws shape_error 204 if the number of joints is wrong.
template <Backend B>
Tensor<B, 4> forward_kinematics(const Skeleton& skeleton, const LanePoses<B>& poses) {
  const Index batch = poses.rot6d.size(0), time = poses.rot6d.size(1), n = poses.rot6d.size(2);
  if (n != skeleton.size())
    raise<shape_error>(204, "forward_kinematics: rotations ", poses.rot6d.shape(), " for ", skeleton.size(), " joints");
  if constexpr (AutodiffBackend<B>) {
    using T = Tensor<B, 2>;
    auto number = [&](Index joint, Index c) {
      return reshape<2>(slice(slice(poses.rot6d, 2, joint, joint + 1), 3, c, c + 1), {batch, time});
    };
    auto vector = [&](Index joint, Index c) {
      return Vec3<T>{number(joint, c), number(joint, c + 1), number(joint, c + 2)};
    };
    std::vector<Rotation6dRows<T>> local;
    for (Index j = 0; j < n; ++j) local.push_back({vector(j, 0), vector(j, 3)});
    auto root = [&](Index c) { return reshape<2>(slice(poses.root, 2, c, c + 1), {batch, time}); };
    const auto world =
        forward_kinematics(skeleton, std::span<const Rotation6dRows<T>>(local), Vec3<T>{root(0), root(1), root(2)});
    std::vector<Tensor<B, 3>> numbers;
    for (const auto& p : world.position) {
      for (const T* c : {&p.x, &p.y, &p.z}) numbers.push_back(reshape<3>(*c, {batch, time, 1}));
    }
    return reshape<4>(concat(std::span<const Tensor<B, 3>>(numbers), 2), {batch, time, n, 3});
  } else {
    using S = typename B::scalar;
    PoolVector<S> joints(static_cast<std::size_t>(batch * time * n * 3));
    forward_kinematics<S>(skeleton, poses.rot6d.span(), poses.root.span(), std::span<S>(joints));
    return Tensor<B, 4>::from(std::span<const S>(joints), {batch, time, n, 3});
  }
}

MOTIONLANG_NAMESPACE_END
