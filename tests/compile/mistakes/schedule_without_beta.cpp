// SPDX-License-Identifier: MIT
// An own noise schedule whose function has another name than the concept asks for.
// expect: s\.beta\(t\)
#include <motionlang/diffusion/schedule.hpp>

namespace ml = motionlang;

struct Constant {
  ml::Index steps = 100;
#ifdef MISTAKE
  double alpha(ml::Index) const { return 0.02; }
#else
  double beta(ml::Index) const { return 0.02; }
#endif
};
static_assert(ml::Schedule<Constant>);
