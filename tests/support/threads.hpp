// SPDX-License-Identifier: MIT
/// A number of threads for one scope.
#pragma once

#include <motionlang/core/parallel.hpp>

struct Threads {
  int before = motionlang::thread_count();

  explicit Threads(int n) { motionlang::set_thread_count(n); }
  ~Threads() { motionlang::set_thread_count(before); }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;
};
