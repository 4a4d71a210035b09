// SPDX-License-Identifier: MIT
// The eigen backend, compiled once for motionlang::instantiated.
#include <motionlang/backend/eigen.ipp>

template struct motionlang::detail::EigenFunctions<float>;
template struct motionlang::detail::EigenFunctions<double>;
