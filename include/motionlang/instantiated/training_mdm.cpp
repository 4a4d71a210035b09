// SPDX-License-Identifier: MIT
// The training of MDM on the tape over the Eigen backend in float, compiled once for
// motionlang::instantiated_training.
#include <motionlang/backend/usual.hpp>
#include <motionlang/train/diffusion_training.hpp>

namespace ml = motionlang;
using A = ml::Autodiff<ml::EigenBackend<float>>;

template class ml::DiffusionTraining<A, ml::MdmSystem>;
template class ml::Trainer<ml::DiffusionTraining<A, ml::MdmSystem>>;
