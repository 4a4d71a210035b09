// SPDX-License-Identifier: MIT
/// Version of the library and the inline namespace that carries it.
#pragma once

#define MOTIONLANG_VERSION_MAJOR 0
#define MOTIONLANG_VERSION_MINOR 1
#define MOTIONLANG_VERSION_PATCH 0
#define MOTIONLANG_VERSION "0.1.0"

/// Every public name lives in `motionlang`, inside this inline namespace. The tag changes with options that change
/// layouts, so that object files built with different options do not link silently against each other.
#ifdef MOTIONLANG_DIAGNOSTICS
#define MOTIONLANG_ABI v0_diag
#else
#define MOTIONLANG_ABI v0
#endif
