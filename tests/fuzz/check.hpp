// What a fuzz target demands of a result: a crash when it does not hold, which the fuzzer reports with its input. And
// what it allows: an error of the library.
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
