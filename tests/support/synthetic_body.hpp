// SPDX-License-Identifier: MIT
/// A tiny body: five vertices, four joints, two shape coefficients.
/// tests/tools/make_pickles.py writes the same one into the pickles of tests/fuzz/corpus/pickle.
#pragma once

#include <cmath>
#include <vector>

#include <motionlang/kinematics/body.hpp>

namespace synthetic {

namespace ml = motionlang;
using ml::Index;

/// s(k, i) = 0.3 sin(0.7 k + 0.31 i + 0.01 i^2) for i = 0 ... count-1
inline std::vector<double> wave(int k, int count) {
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(0.3 * std::sin(0.7 * k + 0.31 * i + 0.01 * (i * i)));
  return out;
}
/// |s| + 0.05, every row divided by its sum.
inline std::vector<double> shares(int k, int rows, int columns) {
  auto out = wave(k, rows * columns);
  for (auto row = out.begin(); row != out.end(); row += columns) {
    double sum = 0;
    for (auto x = row; x != row + columns; ++x) sum += * x = std::abs(*x) + 0.05;
    for (auto x = row; x != row + columns; ++x) *x /= sum;
  }
  return out;
}
inline std::vector<double> template_points() {
  auto out = wave(0, 15);
  for (std::size_t i = 1; i < out.size(); i += 3) out[i] += 1;
  return out;
}

template <ml::Backend B>
ml::BodyModel<B> body() {
  auto matrix = [](const std::vector<double>& v, Index rows, Index columns) {
    return ml::Tensor<B, 2>::from(std::vector<typename B::scalar>(v.begin(), v.end()), {rows, columns});
  };
  return {matrix(template_points(), 5, 3),
          matrix(wave(1, 30), 15, 2),
          matrix(wave(2, 405), 15, 27),
          matrix(shares(3, 4, 5), 4, 5),
          matrix(shares(4, 5, 4), 5, 4),
          {-1, 0, 1, 1},
          {}};
}

inline const std::vector<std::array<Index, 3>> faces{{0, 1, 2}, {0, 2, 3}, {2, 3, 4}};

}  // namespace synthetic
