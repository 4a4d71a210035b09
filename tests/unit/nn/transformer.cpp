// Transformer blocks: configurations, dropout, depth, module paths of errors. Attention itself is in tests/laws and
// tests/ops.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/nn/transformer_decoder.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Offsets;
using B = ml::EigenBackend<double>;
using Matrix = ml::Tensor<B, 2>;
using tensors::distance, tensors::normal, tensors::same_bits;

namespace {

constexpr ml::TransformerConfig small{.d_model = 8, .heads = 2, .d_ff = 12, .layers = 2};

ml::TransformerEncoder<B> encoder(const ml::TransformerConfig& c) {
  ml::Philox rng{.seed = 1};
  return {c, rng};
}

}  // namespace

TEST_CASE("heads have to divide the width") {
  CHECK_ERROR(encoder({.d_model = 8, .heads = 3, .d_ff = 12, .layers = 1}),
              "[motionlang.config.101] MultiheadAttention: 3 heads do not divide width 8");
  CHECK_ERROR(encoder({.d_model = 8, .heads = 0, .d_ff = 12, .layers = 1}), "[motionlang.config.101]");
}

TEST_CASE("no layers change nothing; without weights pre-norm is the identity and post-norm a norm") {
  const ml::Sequences<B> x(normal<B, 2>({5, 8}, 2), Offsets{5});
  CHECK(same_bits(encoder({.d_model = 8, .layers = 0})(x).rows, x.rows));
  for (bool norm_first : {true, false}) {
    auto c = small;
    c.norm_first = norm_first;
    auto silent = encoder(c);
    for (auto& layer : silent.layers) {
      for (auto* last : {&layer.self_attn.out_proj, &layer.linear2})
        last->weight = last->weight * 0.0, last->bias = last->bias * 0.0;
    }
    const auto y = silent(x).rows;
    if (norm_first)
      CHECK(same_bits(y, x.rows));
    else
      CHECK(distance(y, ml::LayerNorm<B>(8)(x.rows)) < 1e-4);  // four norms after each other; eps moves the scale
  }
}

TEST_CASE("a causal stack does not see the future") {
  auto c = small;
  c.causal = true;
  const auto model = encoder(c);
  const auto x = normal<B, 2>({6, 8}, 3);
  const auto other = ml::concat(0, ml::slice(x, 0, 0, 4), normal<B, 2>({2, 8}, 4));
  const auto rows = [&](const Matrix& m) { return ml::slice(model(ml::Sequences<B>(m, Offsets{6})).rows, 0, 0, 4); };
  CHECK(same_bits(rows(x), rows(other)));
  const auto all = encoder(small);
  CHECK_FALSE(same_bits(all(ml::Sequences<B>(x, Offsets{6}))[0], all(ml::Sequences<B>(other, Offsets{6}))[0]));
}

TEST_CASE("batches of one length are the packed ones") {
  const auto model = encoder(small);
  const auto x = normal<B, 3>({2, 3, 8}, 5);
  CHECK(same_bits(ml::from_equal(model(x)).rows, model(ml::from_equal(x)).rows));
}

TEST_CASE("dropout: only with a generator, the same for the same generator, nothing at probability 0") {
  const ml::Sequences<B> x(normal<B, 2>({5, 8}, 2), Offsets{5});
  for (bool norm_first : {true, false}) {
    auto c = small;
    c.norm_first = norm_first;
    const auto model = encoder(c);
    const auto with = [&](std::uint64_t seed) { return model(x, {.dropout = ml::Philox{.seed = seed}}).rows; };
    CHECK(same_bits(with(1), with(1)));
    CHECK_FALSE(same_bits(with(1), with(2)));
    CHECK_FALSE(same_bits(with(1), model(x).rows));
    c.dropout = 0;
    const auto never = encoder(c);
    CHECK(distance(never(x, {.dropout = ml::Philox{}}).rows, never(x).rows) < 1e-13);
    c.dropout = 1;
    CHECK_ERROR(encoder(c)(x, {.dropout = ml::Philox{}}), "[motionlang.config.101] dropout: probability 1");
  }
}

TEST_CASE("dropout: a layer is its formula, operation by operation, mask by mask") {
  ml::Philox rng{.seed = 8};
  const Offsets offsets{3, 17};
  const auto x = normal<B, 2>({20, 8}, 9);
  for (bool norm_first : {false, true}) {
    auto c = small;
    c.norm_first = norm_first;
    const ml::TransformerEncoderLayer<B> layer(c, rng);
    const ml::Context given{.dropout = ml::Philox{.seed = 5}}, again = given;
    const Matrix y = layer(x, offsets, given);

    const auto drop = [&](const Matrix& t) { return ml::dropout(t, c.dropout, again); };
    const auto attend = [&](const Matrix& t) { return drop(layer.self_attn.self(t, offsets, again)); };
    const auto feed = [&](const Matrix& t) { return drop(layer.linear2(drop(layer.linear1(t, c.activation)))); };
    const Matrix middle = norm_first ? x + attend(layer.norm1(x)) : layer.norm1(x + attend(x));
    const Matrix wanted = norm_first ? middle + feed(layer.norm2(middle)) : layer.norm2(middle + feed(middle));
    CHECK(distance(y, wanted) < 1e-13);
    CHECK(again.drawn == given.drawn);
    CHECK(again.drawn == 4);
  }
}

TEST_CASE("a decoder reads its memory, sequence by sequence") {
  ml::Philox rng{.seed = 1};
  const ml::TransformerDecoder<B> model(small, rng);
  const ml::Sequences<B> x(normal<B, 2>({5, 8}, 2), Offsets{2, 3});
  const ml::Sequences<B> memory(normal<B, 2>({3, 8}, 3), Offsets{1, 2});
  auto other = memory;
  other.rows = ml::concat(0, ml::slice(memory.rows, 0, 0, 2), normal<B, 2>({1, 8}, 4));
  CHECK(same_bits(model(x, other)[0], model(x, memory)[0]));
  CHECK_FALSE(same_bits(model(x, other)[1], model(x, memory)[1]));
  CHECK_ERROR(model(x, ml::Sequences<B>(memory.rows, Offsets{3})), "[motionlang.shape.207]");
}
