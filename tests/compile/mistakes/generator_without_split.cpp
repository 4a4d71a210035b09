// SPDX-License-Identifier: MIT
// An own generator that cannot give each part of a model numbers of its own.
// expect: c\.split\(name\)
#include <span>
#include <string_view>

#include <motionlang/core/concepts.hpp>

namespace ml = motionlang;

struct Halves {
  void normal(std::span<float> out) { uniform(out); }
  void uniform(std::span<float> out) {
    for (float& x : out) x = 0.5f;
  }
#ifndef MISTAKE
  Halves split(std::string_view) const { return {}; }
#endif
  Halves split(std::uint64_t) const { return {}; }
};
static_assert(ml::Rng<Halves>);
