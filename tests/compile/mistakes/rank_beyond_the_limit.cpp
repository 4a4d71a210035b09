// SPDX-License-Identifier: MIT
// A tensor of more axes than a shape can hold.
// expect: motionlang::Tensor: rank must be 0 \.\.\. 6
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/tensor.hpp>

namespace ml = motionlang;

#ifdef MISTAKE
ml::Tensor<ml::ReferenceBackend<float>, 7> tensor;
#else
ml::Tensor<ml::ReferenceBackend<float>, 6> tensor;
#endif
