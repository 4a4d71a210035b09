// SPDX-License-Identifier: MIT
// The training of TEMOS on the tape over the Eigen backend in float, compiled once for
// motionlang::instantiated_training.
#include <motionlang/backend/usual.hpp>
#include <motionlang/train/temos_training.hpp>

namespace ml = motionlang;
using A = ml::Autodiff<ml::EigenBackend<float>>;

template class ml::TemosTraining<A>;
template class ml::Trainer<ml::TemosTraining<A>>;
