// SPDX-License-Identifier: MIT
/// Arithmetic and the operations of tensor/fused.hpp as kernels over Dense storage, with their derivatives. Shared by
/// the Eigen and xtensor backends: one layer of kernels serves both.
///
/// Declarations only; the bodies are in kernel_ops.ipp, which a program that links motionlang::instantiated
/// need not read.
#pragma once

#include <array>  // several gradients

#include <motionlang/backend/dense.hpp>
#include <motionlang/core/precision.hpp>
#include <motionlang/tensor/fused.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Scalar S>
struct KernelOps {
  using kernel_tensor = Dense<S>;

  // Operands come by value: the result reuses memory that nobody else holds.
  static Dense<S> add(Dense<S> a, Dense<S> b);
  static Dense<S> sub(Dense<S> a, Dense<S> b);
  static Dense<S> mul(Dense<S> a, Dense<S> b);
  static Dense<S> div(Dense<S> a, Dense<S> b);
  static Dense<S> maximum(Dense<S> a, Dense<S> b);
  static Dense<S> sum(const Dense<S>& a, int axis);

  /// The number of rows inside a network that stay in the caches of all threads from one layer to the next.
  static Index rows_in_cache();

  /// Product of the last two axes, batched. b is packed on the fly.
  static Dense<S> matmul(const Dense<S>& a, const Dense<S>& b, bool transpose_a, bool transpose_b);

  /// Packs a weight (out, in) once, or that of a convolution (out, in, taps). `linear` and `conv1d` then use the packed
  /// form, and the precision for which it was packed. For inference: the weight must not change afterwards. Returns
  /// true if all its values are finite, which it checks while it reads them.
  static bool prepare(const Dense<S>& weight, Precision precision = product_precision());
  /// The precision of products with this weight.
  static Precision precision_of(const Dense<S>& weight);
  static Dense<S> linear(const Dense<S>& x, const Dense<S>& weight, const Dense<S>* bias, Activation act,
                         const Dense<S>* residual, const Dropout& drop = {});

  /// nn/conv1d.hpp, without dilation. `before` gives the sequences of x, `after` those of the result.
  static Dense<S> conv1d(const Dense<S>& x, const Offsets& before, const Offsets& after, const Dense<S>& weight,
                         const Dense<S>* bias, Index stride, Index padding, Activation act);
  static Dense<S> conv1d_weight_vjp(const Dense<S>& x, const Offsets& before, const Offsets& after, Index taps,
                                    Index stride, Index padding, const Dense<S>& dy);
  static Dense<S> conv1d_input_vjp(const Dense<S>& weight, const Offsets& before, const Offsets& after, Index stride,
                                   Index padding, const Dense<S>& dy);

  static Dense<S> activate(const Dense<S>& x, Activation act, const Dropout& drop = {});
  static Dense<S> activate_vjp(const Dense<S>& x, const Dense<S>& dy, Activation act, const Dropout& drop = {});

  static Dense<S> layer_norm(const Dense<S>& x, const Dense<S>& weight, const Dense<S>& bias, double eps);
  static Dense<S> add_layer_norm(const Dense<S>& x, const Dense<S>& residual, const Dense<S>& weight,
                                 const Dense<S>& bias, double eps);
  /// {dx, dweight, dbias}
  static std::array<Dense<S>, 3> layer_norm_vjp(const Dense<S>& x, const Dense<S>& weight, double eps,
                                                const Dense<S>& dy);

  static Dense<S> softmax(const Dense<S>& x);
  static Dense<S> dropout(const Dense<S>& x, const Dropout& d);

  static Dense<S> attention(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v, const Offsets& q_offsets,
                            const Offsets& k_offsets, const AttentionOptions& options,
                            const Dense<S>* relative_scores = nullptr);
  /// {dq, dk, dv}
  static std::array<Dense<S>, 3> attention_vjp(const Dense<S>& q, const Dense<S>& k, const Dense<S>& v,
                                               const Offsets& q_offsets, const Offsets& k_offsets,
                                               const AttentionOptions& options, const Dense<S>& dy);
  static Dense<S> self_attention(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options);
  static Dense<S> self_attention_vjp(const Dense<S>& qkv, const Offsets& offsets, const AttentionOptions& options,
                                     const Dense<S>& dy);

  /// Updates parameter and moments in place if nobody else holds them, else makes new ones.
  static void adamw(Dense<S>& parameter, Dense<S>& m, Dense<S>& v, const Dense<S>& gradient, const AdamwUpdate& update);
};

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED
extern template struct motionlang::KernelOps<float>;
extern template struct motionlang::KernelOps<double>;
#else
#include <motionlang/backend/kernel_ops.ipp>
#endif
