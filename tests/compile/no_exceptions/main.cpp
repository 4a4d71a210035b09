// SPDX-License-Identifier: MIT
// A program that is compiled without exceptions and run-time types: no_exceptions <weights> [timeline]. What is wrong
// ends it, with a message.
#include <cstdio>
#include <cstdlib>

#ifdef OWN_EXIT
#include <exception>
[[noreturn]] static void leave(const std::exception& e) {
  std::printf("left by the caller: %s\n", e.what());
  std::fflush(stdout);
  std::_Exit(0);
}
#define MOTIONLANG_THROW leave
#endif
#include <motionlang/stmc.hpp>

namespace ml = motionlang;

int main(int count, char** arguments) {
  using B = ml::EigenBackend<float>;
  if (count < 2) return 2;
  const auto timeline = ml::parse_timeline(
      count > 2 ? arguments[2] : "walk # 0 # 2 # legs\nraise both arms # 0 # 2 # left arm # right arm\n");
  const auto stmc = ml::load_stmc<B>(arguments[1]);
  const auto features = stmc.generate(timeline, ml::Philox{.seed = 7}, {.steps = 2});
  std::printf("%td frames\n", ml::stmc_motion(features).frames());
}
