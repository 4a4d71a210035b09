// SPDX-License-Identifier: MIT
// The training of STMC on the tape over the Eigen backend in float, compiled once for
// motionlang::instantiated_training.
#include <motionlang/backend/usual.hpp>
#include <motionlang/train/stmc_training.hpp>

namespace ml = motionlang;
using A = ml::Autodiff<ml::EigenBackend<float>>;

template class ml::StmcTraining<A>;
template class ml::Trainer<ml::StmcTraining<A>>;
