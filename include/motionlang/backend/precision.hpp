// SPDX-License-Identifier: MIT
/// The switch for the precision of products. Apart from core/precision.hpp: a header-only program that includes it
/// compiles the kernels of bfloat16.
#pragma once

#include <motionlang/core/precision.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Changes the precision of products for the whole process. Weights that were prepared in another precision are packed
/// anew at every use (but fp32 and bf16x3 use the same): set it before preparing a model.
void set_product_precision(Precision p);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/backend/precision.ipp>
#endif
