// Fuzz targets check results and crash if one is wrong; the fuzzer then reports the input. Errors of the library are
// allowed.
#pragma once

#include <cstdio>
#include <cstdlib>

#include <motionlang/core/error.hpp>

inline void check(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

/// Calls f, which may refuse its input with an E.
template <class E = motionlang::error, class F>
void refusing(F f) {
  try {
    f();
  } catch (const E&) {}
}
