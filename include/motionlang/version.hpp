// SPDX-License-Identifier: MIT
/// The version of the library, and the inline namespace that carries it.
#pragma once

#if __cplusplus < 202002L
#error "motionlang needs C++20: compile with -std=c++20 (GCC 12 or Clang 14 and later)"
#endif

#define MOTIONLANG_VERSION_MAJOR 0
#define MOTIONLANG_VERSION_MINOR 2
#define MOTIONLANG_VERSION_PATCH 0
#define MOTIONLANG_VERSION "0.2.0"

/// Every public name lives in `motionlang`, inside this inline namespace. The tag changes with options that change
/// layouts, and without exceptions. So object files built with different options fail to link instead of mixing
/// silently.
#if defined(MOTIONLANG_DIAGNOSTICS) && defined(__cpp_exceptions)
#define MOTIONLANG_ABI v0_diag
#elif defined(MOTIONLANG_DIAGNOSTICS)
#define MOTIONLANG_ABI v0_diag_no_exceptions
#elif defined(__cpp_exceptions)
#define MOTIONLANG_ABI v0
#else
#define MOTIONLANG_ABI v0_no_exceptions
#endif

/// Stands before every definition in a file *.ipp, which has the bodies of the header of the same name. Without
/// motionlang::instantiated, the header includes that file and all functions are inline. With it, units see
/// declarations only, and the library's own units (instantiated/*.cpp) include the files *.ipp.
#ifdef MOTIONLANG_INSTANTIATED
#define MOTIONLANG_BODY
#else
#define MOTIONLANG_BODY inline
#endif

/// Opens and closes the namespace of the library. It is a macro, so that editors, clang-format and ctags need not know
/// the inline namespace: `ctags -R include` finds every name.
#define MOTIONLANG_NAMESPACE_BEGIN \
  namespace motionlang {           \
  inline namespace MOTIONLANG_ABI {
#define MOTIONLANG_NAMESPACE_END \
  }                              \
  }
