// SPDX-License-Identifier: MIT
/// The usual backends and their tapes. A unit that links motionlang::instantiated and includes this header does not
/// compile them again at -O0. With optimisation, inline functions are compiled again wherever they may be inlined.
#pragma once

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>

#ifdef MOTIONLANG_INSTANTIATED
extern template struct motionlang::ReferenceBackend<float>;
extern template struct motionlang::ReferenceBackend<double>;
#ifndef __clang__  // Clang 14 instantiates members whose constraints do not hold, too: those of a backend with kernels
extern template struct motionlang::Autodiff<motionlang::ReferenceBackend<double>>;
#endif
extern template struct motionlang::Autodiff<motionlang::EigenBackend<float>>;
extern template struct motionlang::Autodiff<motionlang::EigenBackend<double>>;
extern template struct motionlang::Autodiff<motionlang::XtensorBackend<float>>;
#endif
