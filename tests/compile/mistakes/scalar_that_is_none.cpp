// SPDX-License-Identifier: MIT
// A backend over a type that is neither float nor double.
// expect: ReferenceBackend
// expect: Scalar
#include <motionlang/backend/reference.hpp>

#ifdef MISTAKE
using B = motionlang::ReferenceBackend<int>;
#else
using B = motionlang::ReferenceBackend<double>;
#endif
B::tensor tensor = B::full({2}, 1);
