// SPDX-License-Identifier: MIT
// A matrix where a batch of sequences (batch, time, features) is due.
// expect: (invalid initialization|no known conversion).*Tensor<.*, [23]>.*Tensor<.*, [23]>
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/ops.hpp>

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

double energy(const ml::Tensor<B, 3>& sequences);

#ifdef MISTAKE
double result = energy(ml::Tensor<B, 2>::zeros({60, 205}));
#else
double result = energy(ml::Tensor<B, 3>::zeros({1, 60, 205}));
#endif
