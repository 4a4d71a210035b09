// Recurrent networks over packed sequences, and the official names of their parameters.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/nn/gru.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::EigenBackend<double>;
using tensors::distance, tensors::normal;

TEST_CASE("gru: sequences of different lengths go through as if each were alone") {
  ml::Philox rng{.seed = 1};
  const ml::Gru<B> gru(3, 4, 2, rng);
  const ml::Sequences<B> x(normal<B, 2>({12, 3}, 2), Offsets{3, 5, 0, 4});
  const auto h0 = normal<B, 3>({2, 4, 4}, 3);
  const auto together = gru(x), started = gru(x, &h0);
  CHECK(together.offsets == x.offsets);
  for (Index s : {0, 1, 3}) {
    std::vector<ml::Tensor<B, 2>> steps;
    for (Index t = 0; t < x.offsets.length(s); ++t) steps.push_back(ml::slice(x[s], 0, t, t + 1));
    const auto alone = gru(steps);
    CHECK(distance(together[s], ml::concat(std::span<const ml::Tensor<B, 2>>(alone), 0)) < 1e-14);
    const auto own = ml::slice(h0, 1, s, s + 1);
    CHECK(distance(started[s], gru(ml::Sequences<B>(x[s], Offsets{x.offsets.length(s)}), &own).rows) < 1e-14);
    CHECK(distance(started[s], together[s]) > 1e-3);
  }
  const auto other = normal<B, 3>({2, 3, 4}, 3);
  CHECK_ERROR(gru(x, &other), "[motionlang.shape.204]");
  CHECK(gru(ml::Sequences<B>(ml::Tensor<B, 2>::zeros({0, 3}), Offsets{0, 0})).rows.shape() == ml::Shape{0, 4});
}

TEST_CASE("gru: one step after another is the whole sequence, and sequences may end on the way") {
  ml::Philox rng{.seed = 1};
  const ml::Gru<B> gru(3, 4, 2, rng);
  const ml::Sequences<B> x(normal<B, 2>({8, 3}, 2), Offsets{5, 3});  // the longest first
  const auto whole = gru(x);
  std::vector<ml::Tensor<B, 2>> states(2, ml::Tensor<B, 2>::zeros({2, 4}));
  for (Index t = 0; t < 5; ++t) {
    const auto now = ml::slice(x[0], 0, t, t + 1);
    const auto y = ml::gru_step<B>(gru.layers, t < 3 ? ml::concat(0, now, ml::slice(x[1], 0, t, t + 1)) : now, states);
    CHECK(y.size(0) == (t < 3 ? 2 : 1));
    for (Index s = 0; s < y.size(0); ++s)
      CHECK(distance(ml::slice(y, 0, s, s + 1), ml::slice(whole[s], 0, t, t + 1)) < 1e-14);
  }
  states.pop_back();
  CHECK_ERROR(ml::gru_step<B>(gru.layers, ml::slice(x[0], 0, 0, 1), states),
              "[motionlang.shape.204] gru_step: 1 state for 2 layers");
}

TEST_CASE("gru: PyTorch numbers parameters, at any depth") {
  CHECK(ml::gru_key("gru.layers.2.weight_ih") == "gru.weight_ih_l2");
  CHECK(ml::gru_key("encoder.gru.layers.10.bias_hh") == "encoder.gru.bias_hh_l10");
  CHECK(ml::gru_key("recurrent.layers.0.bias_hh", "recurrent") == "recurrent.bias_hh_l0");
  CHECK(ml::gru_key("biggru.layers.0.weight_ih") == "biggru.layers.0.weight_ih");
  CHECK(ml::gru_key("linear1.weight") == "linear1.weight");
}
