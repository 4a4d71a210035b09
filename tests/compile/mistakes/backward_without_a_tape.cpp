// SPDX-License-Identifier: MIT
// Gradients of a loss that was computed on a backend which keeps no graph.
// expect: motionlang::backward\(loss\) requires a loss computed on Autodiff<B>
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/tensor/ops.hpp>

namespace ml = motionlang;
#ifdef MISTAKE
using B = ml::ReferenceBackend<float>;
#else
using B = ml::Autodiff<ml::ReferenceBackend<float> >;
#endif

auto differentiate(const ml::Tensor<B, 0>& loss) { return ml::backward(loss); }
