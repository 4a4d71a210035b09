// SPDX-License-Identifier: MIT
// The reference backend and its tape, compiled once for motionlang::instantiated.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/reference.hpp>

template struct motionlang::ReferenceBackend<float>;
template struct motionlang::ReferenceBackend<double>;
#ifndef __clang__  // see backend/usual.hpp
template struct motionlang::Autodiff<motionlang::ReferenceBackend<double>>;
#endif
