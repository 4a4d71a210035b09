// SPDX-License-Identifier: MIT
/// Lists of numbers and of joint positions: views of them, and how far apart two are.
#pragma once

#include <algorithm>  // max
#include <cmath>      // abs
#include <limits>     // infinity
#include <span>       // view
#include <vector>     // lists

#include <motionlang/geometry/vec.hpp>

namespace lists {

template <class T>
std::span<const T> view(const std::vector<T>& v) {
  return v;
}

/// Largest difference of two numbers at one place; infinity if the lists differ in size.
inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

/// Largest distance of two points at one place; infinity if the lists differ in size.
template <class S, class T>
double largest_distance(const std::vector<motionlang::Vec3<S>>& a, const std::vector<motionlang::Vec3<T>>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    worst = std::max(worst, norm(motionlang::vec_cast<double>(a[i]) - motionlang::vec_cast<double>(b[i])));
  return worst;
}

}  // namespace lists
