// SPDX-License-Identifier: MIT
// A sum of tensors that live on different backends.
// expect: deduced conflicting types for parameter
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/ops.hpp>

namespace ml = motionlang;
#ifdef MISTAKE
using Other = ml::ReferenceBackend<double>;
#else
using Other = ml::ReferenceBackend<float>;
#endif

auto sum(const ml::Tensor<ml::ReferenceBackend<float>, 2>& a, const ml::Tensor<Other, 2>& b) { return a + b; }
