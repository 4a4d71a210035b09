// SPDX-License-Identifier: MIT
/// Contrastive loss with filtered negatives (InfoNCE), for any two modalities.
///
///     info_nce(z_text, z_motion, 0.1, false_negatives(sentences, 0.8))
///     info_nce(z_text, z_motion, exp(log_temperature))                    // the temperature is learned
///     info_nce(z_text, z_motion, 0.1, {}, &z_strangers)                   // with texts that no motion shows
#pragma once

#include <motionlang/loss/cross_entropy.hpp>
#include <motionlang/loss/false_negatives.hpp>
#include <motionlang/tensor/normalize.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The loss for 1 / tau.
template <Backend B>
Tensor<B, 0> scaled_info_nce(const Tensor<B, 2>& x, const Tensor<B, 2>& y, const Tensor<B, 0>& scale,
                             std::span<const unsigned char> filtered, const Tensor<B, 2>* strangers) {
  const Index n = x.size(0);
  if (y.size(0) != n) raise<shape_error>(204, "info_nce: batches of ", x.shape(), ", ", y.shape());
  if (!filtered.empty() && static_cast<Index>(filtered.size()) != n * n)
    raise<shape_error>(205, "info_nce: a filter of ", filtered.size(), " pairs for a batch of ", n);
  auto s = cosine_similarity(x, y) * scale;
  if (!filtered.empty()) {
    std::vector<typename B::scalar> infinity(filtered.size());
    for (std::size_t k = 0; k < filtered.size(); ++k) {
      const bool pair = k % static_cast<std::size_t>(n + 1) == 0;
      if (filtered[k] != 0 && !pair) infinity[k] = static_cast<typename B::scalar>(-1e30);
    }
    s = s + Tensor<B, 2>::from(infinity, {n, n});
  }
  PoolVector<Index> own;
  for (Index i = 0; i < n; ++i) own.push_back(i);
  // thesis eq. 5.1 = TMR eq. 1
  const auto of_x = cross_entropy(s, own);
  if (strangers == nullptr) return (of_x + cross_entropy(transpose(s), own)) * 0.5;
  const auto with_strangers = concat(1, transpose(s), cosine_similarity(y, *strangers) * scale);
  return (of_x + cross_entropy(with_strangers, own)) * 0.5;
}

}  // namespace detail

///     S_ij = cos(x_i, y_j) / tau,   S_ij = -inf where i != j and filtered_ij
///     loss = (CE(S) + CE(S^T)) / 2,   CE(S) = mean_i (log sum_j exp(S_ij) - S_ii)
/// Source    TMR (Petrovich, Black, Varol, ICCV 2023), section 3.2, TMR eq. 1; thesis 5.2.2, thesis eq. 5.1;
///           van den Oord et al. (2018); a learned temperature: CLIP (Radford et al., ICML 2021), section 2.3
/// Differs   from TMR eq. 1 by the filter of section 3.3, which removes pairs from both sums; and, if there are
///           strangers, by their terms exp(cos(y_j, stranger_k) / tau) in the sums of CE(S^T): no y_j may be near them
/// Notation  motion -> x, text -> y, temperature -> tau
/// Shapes    x, y (batch, latent); filtered (batch, batch), see false_negatives, empty: none; strangers (any, latent),
///           null: none -> ()
/// Throws    shape_error 204 if the sizes of the batches differ, 205 for a filter of another size, config_error 101
///           unless temperature > 0
template <Backend B>
Tensor<B, 0> info_nce(const Tensor<B, 2>& x, const Tensor<B, 2>& y, double temperature,
                      std::span<const unsigned char> filtered = {}, const Tensor<B, 2>* strangers = nullptr) {
  if (!(temperature > 0)) raise<config_error>(101, "info_nce: temperature ", temperature);
  return detail::scaled_info_nce(x, y, Tensor<B, 0>(1 / temperature), filtered, strangers);
}
template <Backend B>
Tensor<B, 0> info_nce(const Tensor<B, 2>& x, const Tensor<B, 2>& y, const Tensor<B, 0>& temperature,
                      std::span<const unsigned char> filtered = {}, const Tensor<B, 2>* strangers = nullptr) {
  if (!(temperature.item() > 0)) raise<config_error>(101, "info_nce: temperature ", temperature.item());
  return detail::scaled_info_nce(x, y, 1.0 / temperature, filtered, strangers);
}

MOTIONLANG_NAMESPACE_END
