// SPDX-License-Identifier: MIT
// An own representation of rotations that cannot be converted: the rest is deduced from its matrix.
// expect: to_matrix\(r\)
#include <motionlang/geometry/matrix.hpp>

namespace ml = motionlang;

namespace own {
struct HalfTurnAboutY {};
#ifndef MISTAKE
ml::Matrix3<double> to_matrix(const HalfTurnAboutY&) { return {{-1, 0, 0, 0, 1, 0, 0, 0, -1}}; }
#endif
}  // namespace own
static_assert(ml::Rotation<own::HalfTurnAboutY>);
