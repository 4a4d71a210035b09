// SPDX-License-Identifier: MIT
// The training of MDM on motions of actions on the tape over the Eigen backend in float, compiled once for
// motionlang::instantiated_training.
#include <motionlang/backend/usual.hpp>
#include <motionlang/train/mdm_action_training.hpp>

namespace ml = motionlang;
using A = ml::Autodiff<ml::EigenBackend<float>>;

template class ml::MdmActionTraining<A>;
template class ml::Trainer<ml::MdmActionTraining<A>>;
