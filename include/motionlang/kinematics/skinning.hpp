// SPDX-License-Identifier: MIT
/// Linear blend skinning of many poses on a processor: the kernel of body models on bare backends.
///
///     vertex_i = sum_j w_ij (R_j v_i + t_j)
///
/// A vertex follows few joints (SMPL: at most four), so only weights that are not 0 are visited. Transforms are columns of four
/// numbers, two of which fill a register.
/// Source    Loper et al. (2015), eq. 2
#pragma once

#include <algorithm>  // min
#include <span>       // weights
#include <vector>     // lists

#include <motionlang/core/concepts.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// The weights that are not 0, vertex by vertex.
template <Scalar S>
class SkinWeights {
 public:
  struct Entry {
    int joint;
    S weight;
  };
  SkinWeights() = default;
  /// From all of them, (vertices, joints).
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

/// Numbers of a joint's transform: three columns of R and t, each with a fourth number that is ignored.
inline constexpr Index skin_transform_size = 16;

/// Vertices first ... last - 1 of all poses.
/// posed        (poses, last - first, 3): the vertices before they are moved
/// transforms   (poses, joints, 16)
/// vertices     (poses, all vertices, 3)
template <Scalar S>
void skin_vertices(const SkinWeights<S>& weights, Index first, Index last, const S* posed, const S* transforms, Index poses,
                   Index joints, S* vertices) {
  typedef S Four __attribute__((vector_size(4 * sizeof(S))));
  typedef S Eight __attribute__((vector_size(8 * sizeof(S)), aligned(alignof(S)), may_alias));  // two columns
  constexpr Index block = 8;  // poses whose transforms stay in the first cache while the vertices go by
  const Index row = 3 * (last - first), whole_row = 3 * weights.vertices();
  for (Index top = 0; top < poses; top += block) {
    for (Index v = first; v < last; ++v) {
      const auto entries = weights.of(v);
      for (Index pose = top; pose < std::min(poses, top + block); ++pose) {
        const S* const own = transforms + pose * joints * skin_transform_size;
        Eight xy{}, zt{};
        for (const auto& e : entries) {
          const Eight* const columns = reinterpret_cast<const Eight*>(own + e.joint * skin_transform_size);
          xy += e.weight * columns[0];
          zt += e.weight * columns[1];
        }
        const S* const from = posed + pose * row + 3 * (v - first);
        const S x = from[0], y = from[1], z = from[2];
        const Eight sum = xy * Eight{x, x, x, x, y, y, y, y} + zt * Eight{z, z, z, z, 1, 1, 1, 1};
        const Four p = __builtin_shufflevector(sum, sum, 0, 1, 2, 3) + __builtin_shufflevector(sum, sum, 4, 5, 6, 7);
        S* const to = vertices + pose * whole_row + 3 * v;
        to[0] = p[0], to[1] = p[1], to[2] = p[2];
      }
    }
  }
}

}  // namespace motionlang::inline MOTIONLANG_ABI
