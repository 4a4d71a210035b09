// SPDX-License-Identifier: MIT
/// Rotations that hurt: at the identity, 1e-8 from it, random, and near and at half a turn.
#pragma once

#include <numbers>  // pi
#include <vector>   // samples

#include <motionlang/core/rng.hpp>
#include <motionlang/geometry/axis_angle.hpp>

namespace rotations {

namespace ml = motionlang;

template <class S>
inline constexpr double tolerance = sizeof(S) == 4 ? 2e-6 : 2e-14;

template <class S>
std::vector<ml::Vec3<S>> vectors() {
  std::vector<ml::Vec3<S>> out{
      {S(0), S(0), S(0)}, {S(1e-8), S(0), S(0)}, {S(0), S(-1e-8), S(1e-8)}, {S(1e-4), S(1e-4), S(0)}};
  const double pi = std::numbers::pi;
  ml::Philox rng{.seed = 3};
  for (int i = 0; i < 40; ++i) {
    std::vector<double> n(3);
    rng.normal(std::span<double>(n));
    const auto axis = ml::normalized(ml::Vec3{n[0], n[1], n[2]});
    for (double angle : {rng.uniform() * pi, 0.5 * pi, pi - 1e-3, pi - 1e-7, pi})
      out.push_back(ml::vec_cast<S>(angle * axis));
  }
  for (const auto& a : {ml::Vec3{pi, 0.0, 0.0}, ml::Vec3{0.0, -pi, 0.0}, ml::Vec3{0.0, 0.0, pi},
                        pi * std::sqrt(0.5) * ml::Vec3{1.0, -1.0, 0.0}}) {
    out.push_back(ml::vec_cast<S>(a));
  }
  return out;
}

/// Largest difference of two entries.
template <class S>
double difference(const ml::Matrix3<S>& a, const ml::Matrix3<S>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < 9; ++i) worst = std::max(worst, std::abs(double(a.m[i]) - double(b.m[i])));
  return worst;
}

template <class S>
double length(const ml::Vec3<S>& v) {
  return double(ml::norm(v));
}

}  // namespace rotations
