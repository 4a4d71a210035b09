// SPDX-License-Identifier: MIT
// The xtensor backend, compiled once for motionlang::instantiated.
#include <motionlang/backend/detail/xtensor_impl.hpp>

template struct motionlang::XtensorBackend<float>;
template struct motionlang::XtensorBackend<double>;
