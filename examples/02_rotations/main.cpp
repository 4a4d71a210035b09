// One rotation in every representation, and the way between two.
#include <cstdio>
#include <numbers>

#include <motionlang/geometry/euler.hpp>
#include <motionlang/geometry/rotation6d.hpp>
#include <motionlang/geometry/slerp.hpp>
#include <motionlang/geometry/so3.hpp>

namespace ml = motionlang;

int main() {
  const double quarter = std::numbers::pi / 2;
  const ml::AxisAngle<double> turn{{0, quarter, 0}};  // a quarter turn about y
  const auto q = ml::to_quaternion(turn);
  const auto r = ml::to_matrix(turn);
  std::printf("quaternion  %.4f %.4f %.4f %.4f\n", q.w, q.x, q.y, q.z);
  std::printf("matrix      row 0: %.4f %.4f %.4f\n", r(0, 0), r(0, 1), r(0, 2));
  const auto rows = ml::to_rotation6d_rows(r);
  std::printf("6D, rows    %.4f %.4f %.4f  %.4f %.4f %.4f\n", rows.a.x, rows.a.y, rows.a.z, rows.b.x, rows.b.y,
              rows.b.z);

  // exp and log are inverse to each other, also next to 0
  const ml::Vec3<double> tiny{1e-9, 0, 0};
  std::printf("log(exp(v)) %.2e for v = 1e-9\n", ml::log_so3(ml::exp_so3(tiny)).x);

  // Half of the way to the rotation, at constant speed
  const auto half = ml::slerp(ml::Quaternion<double>::identity(), q, 0.5);
  std::printf("slerp       %.1f degrees of %.1f\n",
              180 / std::numbers::pi * ml::distance(ml::Quaternion<double>::identity(), half),
              180 / std::numbers::pi * ml::distance(ml::Quaternion<double>::identity(), q));
}
