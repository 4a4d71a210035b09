// SPDX-License-Identifier: MIT
/// The choice of the precision of products, for one model or for the process. It is not in core/precision.hpp, because
/// a header-only program that includes it compiles the kernels of bfloat16.
///
/// A prepared weight keeps the precision for which it was packed, and layers read it there. So models of different
/// precisions can be used side by side, and no later setting changes them. The setting of the process is for products
/// without a prepared weight: models in training, whose weights change with every step, and products of two results.
#pragma once

#include <motionlang/core/precision.hpp>
#include <motionlang/tensor/module.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Changes the precision for the whole process: that of weights prepared from now on, and of products without one. Do
/// not call it while work is running.
void set_product_precision(Precision p);

namespace detail {
/// Makes the kernels of all precisions callable.
void use_all_precisions();
}  // namespace detail

/// Makes a model ready for inference in a precision of its own: `prepare` of tensor/module.hpp has the rest.
///
///     prepare(stmc.denoiser, Precision::bf16);
template <Module M>
void prepare(M& model, Precision precision) {
  detail::use_all_precisions();
  detail::prepare_in(model, precision);
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/backend/precision.ipp>
#endif
