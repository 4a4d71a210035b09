// SPDX-License-Identifier: MIT
// Tasks that have tasks of their own, over the copy of the library that includes this.
#pragma once

#include <atomic>

#include <motionlang/core/parallel.hpp>

inline int nested_tasks() {
  std::atomic<int> done{0};
  motionlang::set_thread_count(3);
  for (int i = 0; i < 100; ++i) {
    motionlang::parallel_for(
        8, [&](motionlang::Index) { motionlang::parallel_for(4, [&](motionlang::Index) { ++done; }); });
  }
  return done;
}
