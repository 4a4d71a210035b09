// SPDX-License-Identifier: MIT
/// Maps vectors to the nearest entry of a codebook, and back: motions become words of a finite vocabulary.
#pragma once

#include <motionlang/nn/embedding.hpp>
#include <motionlang/tensor/arg_max.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The effective number of codes in use:  exp(-sum_k p_k log(p_k + 1e-10)),   p_k: share of code k
double code_perplexity(std::span<const Index> codes, Index codebook);

/// The result of quantising vectors z.
template <Backend B>
struct Quantized {
  std::vector<Index> codes;  // k_i = arg min_k |z_i - e_k|, the first among equals
  Tensor<B, 2> rows;         // e_k
  /// The same values, but gradients bypass the choice and go to z:  z + sg(e_k - z),  sg: as a constant
  Tensor<B, 2> straight_through;
  ///     mean (e - sg z)^2 + beta mean (sg e - z)^2
  Tensor<B, 0> loss;
  double perplexity = 0;
};

/// Source  van den Oord, Vinyals, Kavukcuoglu, "Neural discrete representation learning" (NeurIPS 2017), eq. 1-3. TM2T
///         has beta 1 and no moving averages (its "q_mode cmt").
template <Backend B>
struct VectorQuantizer {
  Embedding<B> embedding;  // (codes, width)
  double beta = 1;

  static constexpr auto fields() {
    return motionlang::fields("embedding", &VectorQuantizer::embedding, "beta", &VectorQuantizer::beta);
  }
  VectorQuantizer() = default;
  /// Uniform within 1 / codes.
  VectorQuantizer(Index codes, Index width, double beta_, Rng auto& rng) : beta(beta_) {
    embedding.weight = uniform_init<B, 2>({codes, width}, 1 / static_cast<double>(codes), rng);
  }

  Index size() const { return embedding.weight.size(0); }

  /// The nearest codes of (rows, width): TM2T eq. 1. |z|^2 is the same for all codes, so it is left out. Throws
  /// shape_error 201.
  std::vector<Index> codes(const Tensor<B, 2>& z) const {
    const auto e = stop_gradient(embedding.weight);
    return arg_max(matmul(stop_gradient(z), e, {.transpose_b = true}) * 2.0 - sum(square(e), 1));
  }
  Quantized<B> operator()(const Tensor<B, 2>& z) const {
    const ModuleScope scope(*this);
    Quantized<B> out;
    out.codes = codes(z);
    out.rows = embedding(out.codes);
    out.straight_through = z + stop_gradient(out.rows - z);
    out.loss = mean(square(out.rows - stop_gradient(z))) + mean(square(stop_gradient(out.rows) - z)) * beta;
    out.perplexity = code_perplexity(out.codes, size());
    return out;
  }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/nn/vector_quantizer.ipp>
#endif
