// A backend of your own: every model runs on it.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/nn/transformer_encoder.hpp>

#include "counting_backend.hpp"

namespace ml = motionlang;
using Eigen = ml::EigenBackend<float>;
using Counting = CountingBackend<Eigen>;
static_assert(ml::Backend<Counting>);

int main() {
  ml::Philox rng{.seed = 1};
  const ml::TransformerEncoder<Eigen> model({.d_model = 32, .heads = 4, .d_ff = 64, .layers = 1}, rng);
  const ml::Sequences<Eigen> x(ml::Tensor<Eigen, 2>::randn({5, 32}, rng), ml::Offsets{2, 3});  // 2 and 3 frames

  const auto same_model = ml::convert<Counting>(model);
  const ml::Sequences<Counting> same_x(ml::Tensor<Counting, 2>::from(x.rows.to_vector(), x.rows.shape()), x.offsets);
  Counting::reset();
  const auto counted = same_model(same_x).rows;
  for (const auto& [operation, times] : Counting::counts()) std::printf("%-10s %3td\n", operation.data(), times);

  const auto wanted = model(x).rows;
  float largest = 0;
  for (std::size_t i = 0; i < wanted.span().size(); ++i)
    largest = std::max(largest, std::abs(wanted.span()[i] - counted.span()[i]));
  std::printf("as on the inner backend: %s\n", largest < 1e-5F ? "yes" : "no");
}
