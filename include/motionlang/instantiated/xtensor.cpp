// SPDX-License-Identifier: MIT
// The xtensor backend, compiled once for motionlang::instantiated.
#include <motionlang/backend/xtensor.ipp>

template struct motionlang::XtensorBackend<float>;
template struct motionlang::XtensorBackend<double>;
