// SPDX-License-Identifier: MIT
// An own backend that lacks an operation: the proof under it names the operation.
// expect: B::tanh\(a\)
#include <motionlang/backend/reference.hpp>

namespace ml = motionlang;

struct Mine : ml::ReferenceBackend<float> {
#ifdef MISTAKE
  static tensor tanh(const tensor&) = delete;
#endif
};
static_assert(ml::Backend<Mine>);
