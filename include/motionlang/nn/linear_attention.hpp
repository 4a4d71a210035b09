// SPDX-License-Identifier: MIT
/// Attention whose cost grows linearly with the length (MotionDiffuse's "efficient attention").
#pragma once

#include <motionlang/tensor/fused.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Per head: softmax of q over its channels, softmax of k over time, A = k^T v, y = q A.
/// Source  Shen et al. (2021), "Efficient attention", as used by MotionDiffuse (Zhang et al. 2022), section 3.3
/// Shapes  q (query rows, width), k and v (key rows, width) -> (query rows, width)
template <Backend B>
Tensor<B, 2> linear_attention(const Tensor<B, 2>& q, const Tensor<B, 2>& k, const Tensor<B, 2>& v,
                              const Offsets& q_offsets, const Offsets& k_offsets, Index heads) {
  detail::check_attention(q, k, v, q_offsets, k_offsets, {.heads = heads});
  const Index d = q.size(1), width = d / heads;
  const auto by_head = [&](const Tensor<B, 2>& rows) {
    return permute(reshape<3>(rows, {rows.size(0), heads, width}), {1, 0, 2});
  };
  const auto channels = reshape<2>(softmax(reshape<2>(q, {q.size(0) * heads, width})), {q.size(0), d});
  PoolVector<Tensor<B, 2>> sequences;
  for (Index s = 0; s < q_offsets.count(); ++s) {
    const auto qs = slice(channels, 0, q_offsets.begin(s), q_offsets.end(s));
    const auto ks = softmax(transpose(slice(k, 0, k_offsets.begin(s), k_offsets.end(s))));  // (d, time)
    const auto vs = slice(v, 0, k_offsets.begin(s), k_offsets.end(s));
    const auto a = matmul(reshape<3>(ks, {heads, width, k_offsets.length(s)}), by_head(vs));  // (heads, width, width)
    sequences.push_back(reshape<2>(permute(matmul(by_head(qs), a), {1, 0, 2}), {q_offsets.length(s), d}));
  }
  return sequences.empty() ? q : concat(std::span<const Tensor<B, 2>>(sequences), 0);
}

MOTIONLANG_NAMESPACE_END
