// SPDX-License-Identifier: MIT
// The tape over the xtensor backend, compiled once for motionlang::instantiated.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/xtensor.hpp>

template struct motionlang::Autodiff<motionlang::XtensorBackend<float>>;
