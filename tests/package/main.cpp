// SPDX-License-Identifier: MIT
// The program of a new user, built in every way in which the library can be had. Fails unless the library answers.
#include <cstdio>

#include <motionlang/stmc.hpp>

namespace ml = motionlang;

int main() {
  const auto timeline = ml::parse_timeline("walk forward # 0.0 # 6.0 # legs\nraise both arms # 2.0 # 5.0 # left arm\n");
  std::printf("motionlang %s: %zu texts in %ld frames\n", MOTIONLANG_VERSION, timeline.intervals.size(),
              static_cast<long>(timeline.end()));
  return timeline.end() == 120 ? 0 : 1;
}
