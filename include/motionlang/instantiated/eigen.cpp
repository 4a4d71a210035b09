// SPDX-License-Identifier: MIT
// The eigen backend, compiled once for motionlang::instantiated.
#include <motionlang/backend/eigen.ipp>

template struct motionlang::EigenBackend<float>;
template struct motionlang::EigenBackend<double>;
