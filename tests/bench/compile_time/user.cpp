// SPDX-License-Identifier: MIT
// The unit of a user: a timeline in, a motion out.
#include <cstdio>

#include <motionlang/stmc.hpp>

namespace ml = motionlang;

int main() {
  using B = ml::EigenBackend<float>;
  const auto stmc = ml::load_stmc<B>("stmc_free.safetensors");
  const auto timeline = ml::parse_timeline(
      "walk forward # 0.0 # 6.0 # legs\n"
      "raise both arms # 2.0 # 5.0 # left arm # right arm\n");
  const ml::Motion motion = ml::generate_motion(stmc, timeline, {.seed = 7});
  std::printf("%zu frames\n", motion.local.size());
}
