// SPDX-License-Identifier: MIT
/// Linear blend skinning of many poses on a processor: the kernel of body models on bare backends.
///
///     vertex_i = sum_j w_ij (R_j v_i + t_j)
///
/// A vertex follows few joints (SMPL: at most four), so only weights that are not 0 are visited. Transforms are columns of four
/// numbers, which fit a register of every processor.
/// Source    Loper et al. (2015), eq. 2
#pragma once

#include <algorithm>  // min
#include <span>       // weights
#include <vector>     // lists

#include <motionlang/core/concepts.hpp>
#include <motionlang/core/parallel.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// The weights that are not 0, vertex by vertex.
template <Scalar S>
class SkinWeights {
 public:
  struct Entry {
    int joint;
    S weight;
  };
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

/// posed        (poses, vertices, 3): the vertices before they are moved
/// transforms   (poses, joints, 16)
/// vertices     (poses, vertices, 3); may be `posed`
template <Scalar S>
void skin_vertices(const SkinWeights<S>& weights, const S* posed, const S* transforms, Index poses, Index joints,
                   S* vertices) {
  typedef S Four __attribute__((vector_size(4 * sizeof(S)), aligned(alignof(S)), may_alias));
  constexpr Index block = 8;  // poses whose transforms stay in the first cache while the vertices go by
  const Index count = weights.vertices(), row = 3 * count;
  parallel_for((poses + block - 1) / block, [&](Index b) {
    const Index first = b * block, last = std::min(poses, first + block);
    for (Index v = 0; v < count; ++v) {
      const auto entries = weights.of(v);
      for (Index pose = first; pose < last; ++pose) {
        const S* const own = transforms + pose * joints * skin_transform_size;
        Four x{}, y{}, z{}, t{};
        for (const auto& e : entries) {
          const Four* const columns = reinterpret_cast<const Four*>(own + e.joint * skin_transform_size);
          x += e.weight * columns[0];
          y += e.weight * columns[1];
          z += e.weight * columns[2];
          t += e.weight * columns[3];
        }
        const S* const from = posed + pose * row + 3 * v;
        const Four p = x * from[0] + y * from[1] + z * from[2] + t;
        S* const to = vertices + pose * row + 3 * v;
        to[0] = p[0], to[1] = p[1], to[2] = p[2];
      }
    }
  });
}

}  // namespace motionlang::inline MOTIONLANG_ABI
