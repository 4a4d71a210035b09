// SPDX-License-Identifier: MIT
/// Linear blend skinning of many poses on the CPU: the kernel of body models on bare backends.
///
///     vertex_i = sum_j w_ij (R_j v_i + t_j)
///
/// A vertex follows few joints (SMPL: at most four), so only nonzero weights are visited. Every lane of a register
/// holds another pose.
/// Source    Loper et al. (2015), eq. 2
#pragma once

#include <algorithm>  // min
#include <array>      // a transform
#include <span>       // weights
#include <vector>     // lists

#include <motionlang/core/lane_rows.hpp>
#include <motionlang/geometry/vec.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The nonzero weights, vertex by vertex.
template <Scalar S>
class SkinWeights {
 public:
  struct Entry {
    int joint;
    S weight;
  };
  SkinWeights() = default;
  /// From all weights, (vertices, joints).
  SkinWeights(std::span<const S> dense, Index joints) {
    for (std::size_t at = 0; at < dense.size(); at += static_cast<std::size_t>(joints)) {
      for (Index j = 0; j < joints; ++j) {
        if (const S w = dense[at + static_cast<std::size_t>(j)]; w != S(0)) {
          entries_.push_back({static_cast<int>(j), w});
        }
      }
      ends_.push_back(entries_.size());
    }
  }
  Index vertices() const { return static_cast<Index>(ends_.size()) - 1; }
  std::span<const Entry> of(Index vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return std::span(entries_).subspan(ends_[v], ends_[v + 1] - ends_[v]);
  }

 private:
  std::vector<Entry> entries_;
  std::vector<std::size_t> ends_{0};
};

/// The values of a joint's transform, row by row: [R | t].
inline constexpr Index skin_transform_size = 12;
/// The number of bytes for the transforms of this many poses, padded to whole registers of any width.
template <Scalar S>
constexpr std::size_t skin_transform_bytes(Index poses, Index joints) {
  constexpr Index most = 64 / sizeof(S);
  return static_cast<std::size_t>((poses + most - 1) / most * most * joints * skin_transform_size) * sizeof(S);
}

/// Skins vertices first ... last - 1 of up to L::size poses.
/// posed        (poses, last - first, 3): the vertices before they are moved
/// transforms   (joints, 12)
/// vertices     (poses, all vertices, 3), starting with the first pose
template <class L, Scalar S>
void skin_vertices(const SkinWeights<S>& weights, Index first, Index last, const S* posed, const L* transforms,
                   int poses, S* vertices) {
  constexpr Index some = 4;  // vertices, whose twelve values are three fours, for load_rows
  const auto row = static_cast<std::size_t>(3 * (last - first)),
             whole_row = static_cast<std::size_t>(3 * weights.vertices());
  for (Index v = first; v < last; v += some) {
    const Index count = std::min(some, last - v);
    std::array<Vec3<L>, some> points;
    const auto numbers = std::span<L>(&points[0].x, static_cast<std::size_t>(3 * count));
    static_assert(sizeof(points) == 3 * some * sizeof(L));
    load_rows(posed + 3 * (v - first), row, poses, numbers);
    for (int i = 0; i < poses; ++i)  // the place of the results of some steps later
      __builtin_prefetch(vertices + static_cast<std::size_t>(i) * whole_row + 3 * std::min(v + 4 * some, last), 1);
    for (Index i = 0; i < count; ++i) {
      std::array<L, skin_transform_size> m;
      for (const auto& e : weights.of(v + i)) {
        const L weight(e.weight), *const own = transforms + e.joint * skin_transform_size;
        for (std::size_t k = 0; k < m.size(); ++k) m[k] = m[k] + weight * own[k];
      }
      Vec3<L>& p = points[static_cast<std::size_t>(i)];
      const L x = p.x, y = p.y, z = p.z;
      p.x = m[0] * x + m[1] * y + m[2] * z + m[3];
      p.y = m[4] * x + m[5] * y + m[6] * z + m[7];
      p.z = m[8] * x + m[9] * y + m[10] * z + m[11];
    }
    store_rows(std::span<const L>(numbers), whole_row, poses, vertices + 3 * v);
  }
}

MOTIONLANG_NAMESPACE_END
