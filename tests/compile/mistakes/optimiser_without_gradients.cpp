// SPDX-License-Identifier: MIT
// An optimiser over a backend that cannot differentiate.
// expect: AdamW
// expect: AutodiffBackend
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/optim/adamw.hpp>

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

#ifdef MISTAKE
ml::AdamW<B> optimiser{{.lr = 1e-4}};
#else
ml::AdamW<ml::Autodiff<B> > optimiser{{.lr = 1e-4}};
#endif
