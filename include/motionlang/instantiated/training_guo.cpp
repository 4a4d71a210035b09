// SPDX-License-Identifier: MIT
// The training of Guo's evaluator on the tape over the Eigen backend in float, compiled once for
// motionlang::instantiated_training.
#include <motionlang/backend/usual.hpp>
#include <motionlang/train/guo_matching_training.hpp>
#include <motionlang/train/guo_movement_training.hpp>

namespace ml = motionlang;
using A = ml::Autodiff<ml::EigenBackend<float>>;

template class ml::GuoMovementTraining<A>;
template class ml::Trainer<ml::GuoMovementTraining<A>>;
template class ml::GuoMatchingTraining<A>;
template class ml::Trainer<ml::GuoMatchingTraining<A>>;
