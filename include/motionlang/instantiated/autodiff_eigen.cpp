// SPDX-License-Identifier: MIT
// The tape over the Eigen backend, compiled once for motionlang::instantiated.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>

template struct motionlang::Autodiff<motionlang::EigenBackend<float>>;
template struct motionlang::Autodiff<motionlang::EigenBackend<double>>;
