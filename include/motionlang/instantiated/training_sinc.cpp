// SPDX-License-Identifier: MIT
// The training of SINC on the tape over the Eigen backend in float, compiled once for
// motionlang::instantiated_training.
#include <motionlang/backend/usual.hpp>
#include <motionlang/train/sinc_training.hpp>

namespace ml = motionlang;
using A = ml::Autodiff<ml::EigenBackend<float>>;

template class ml::SincTraining<A>;
template class ml::Trainer<ml::SincTraining<A>>;
