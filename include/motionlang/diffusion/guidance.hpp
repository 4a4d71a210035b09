// SPDX-License-Identifier: MIT
/// Classifier-free guidance.
#pragma once

#include <motionlang/tensor/ops.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     guided = null + w (cond - null)
/// Source  Ho and Salimans (2022), eq. 6 in the form that all motion models use. It applies to any prediction of the
///         network, before clipping, inpainting and stitching. With w = 1 the unconditional call can be left out.
template <Backend B, int R>
Tensor<B, R> guide(const Tensor<B, R>& cond, const Tensor<B, R>& null, double w) {
  return null + (cond - null) * w;
}
/// One weight per sample (leading index).
template <Backend B, int R>
Tensor<B, R> guide(const Tensor<B, R>& cond, const Tensor<B, R>& null, const Tensor<B, R>& w) {
  return null + (cond - null) * w;
}

MOTIONLANG_NAMESPACE_END
