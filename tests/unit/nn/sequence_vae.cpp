// Sequence autoencoders: sampling, tokens through a stack, one row of memory, dropout, copied layers.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/core/offsets.hpp>
#include <motionlang/nn/multihead_attention.hpp>
#include <motionlang/nn/sequence_vae.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::EigenBackend<double>;
using A = ml::Autodiff<B>;
using Matrix = ml::Tensor<B, 2>;
using tensors::distance, tensors::normal, tensors::same_bits;

namespace {

constexpr ml::TransformerConfig small{.d_model = 8, .heads = 2, .d_ff = 12, .layers = 2};

template <class Stack>
Stack stack(const ml::TransformerConfig& c = small) {
  ml::Philox rng{.seed = 1};
  return {c, rng};
}
ml::SequenceDecoder<B> decoder() {
  ml::Philox rng{.seed = 2};
  return {5, small, 16, rng};
}

}  // namespace

TEST_CASE("a sample is mu + fact eps std; without variance it is mu") {
  const ml::LatentGaussian<B> g{Matrix::from({1, 2}, {1, 2}), Matrix::from({0, 2 * std::log(3.0)}, {1, 2})};
  const auto eps = Matrix::from({-1, 0.5}, {1, 2});
  CHECK(distance(g.sample(eps), Matrix::from({0, 3.5}, {1, 2})) < 1e-15);
  CHECK(distance(g.sample(eps, 2), Matrix::from({-1, 5}, {1, 2})) < 1e-15);
  CHECK(same_bits(g.sample(eps, 0), g.mu));
  ml::Philox a{.seed = 3}, b{.seed = 3};
  CHECK(same_bits(g.sample(a), g.sample(b)));
  CHECK_FALSE(same_bits(g.sample(a), g.mu));
  CHECK_ERROR(g.sample(Matrix::zeros({1, 1})), "[motionlang.shape.204] LatentGaussian: eps (1, 1) for mu (1, 2)");
  const ml::LatentGaussian<B> point{g.mu, {}};
  CHECK(point.deterministic());
  CHECK(same_bits(point.sample(a), g.mu));
}

TEST_CASE("the rows of the tokens are those of the whole stack") {
  const auto encoder = stack<ml::TransformerEncoder<B>>();
  const ml::Sequences<B> x(normal<B, 2>({9, 8}, 4), Offsets{2, 3, 4});
  const auto tokens = ml::encode_tokens(encoder, x, 2, 0.1);
  CHECK(tokens.offsets == Offsets{2, 2, 2});
  CHECK(distance(tokens.rows, ml::first_rows(encoder(x), 2).rows) < 1e-13);
  const auto g = ml::gaussian_of_tokens(tokens);
  CHECK(same_bits(ml::slice(g.logvar, 0, 1, 2), ml::slice(tokens[1], 0, 1, 2)));
  CHECK(ml::gaussian_of_tokens(ml::encode_tokens(encoder, x, 1, 0.1)).deterministic());
  CHECK(same_bits(ml::encode_tokens(stack<ml::TransformerEncoder<B>>({.d_model = 8, .layers = 0}), x, 2, 0.1).rows,
                  ml::first_rows(x, 2).rows));
  CHECK_ERROR(ml::first_rows(x, 3), "[motionlang.shape.207] first_rows: 3 of 2 rows of sequence 0");
  auto other = small;
  other.norm_first = true;
  CHECK_ERROR(ml::encode_tokens(stack<ml::TransformerEncoder<B>>(other), x, 2, 0.1), "[motionlang.config.101]");
}

TEST_CASE("a sequence has the same latent and the same frames alone and among others") {
  const auto encoder = stack<ml::TransformerEncoder<B>>();
  const auto table = ml::sinusoidal_positions<B>(16, 8);
  const auto learned = normal<B, 2>({2, 8}, 5);
  auto encode = [&](const ml::Sequences<B>& x) {
    return ml::encode_tokens(encoder, ml::token_sequence(ml::repeat_sequence(learned, x.count()), x, table), 2, 0.1)
        .rows;
  };
  const ml::Sequences<B> x(normal<B, 2>({6, 8}, 6), Offsets{5, 0, 1});
  for (Index i = 0; i < 3; ++i) {
    const ml::Sequences<B> alone(x[i], Offsets{x.offsets.length(i)});
    CHECK(distance(encode(alone), ml::slice(encode(x), 0, 2 * i, 2 * i + 2)) < 1e-13);
  }
  const auto decode = decoder();
  const auto z = normal<B, 2>({3, 8}, 7);
  const auto y = decode(z, Offsets{4, 0, 2});
  CHECK(y.offsets == Offsets{4, 0, 2});
  CHECK(distance(decode(ml::slice(z, 0, 2, 3), Offsets{2})[0], y[2]) < 1e-13);
  CHECK_ERROR(decode(z, Offsets{1, 1, 17}), "[motionlang.shape.203]");
  CHECK_ERROR(decode(z, Offsets{1, 1}), "[motionlang.shape.207]");
}

TEST_CASE("many sequences go through the layers in groups, with the same bits") {
  const auto encoder = stack<ml::TransformerEncoder<B>>();
  const auto decode = decoder();
  const Index count = B::rows_in_cache() / 6;  // of 11 rows on average: more than one group
  std::vector<Index> frames;
  for (Index i = 0; i < count; ++i) frames.push_back(6 + 5 * (i % 3));
  const Offsets lengths(frames);
  const ml::Sequences<B> x(normal<B, 2>({lengths.rows(), 8}, 20), lengths);
  const auto z = normal<B, 2>({count, 8}, 21);
  const auto tokens = ml::encode_tokens(encoder, x, 2, 0.1);
  const auto rows = encoder(x);
  const auto y = decode(z, lengths);
  CHECK(tokens.offsets == Offsets::equal(count, 2));
  CHECK(y.offsets == lengths);
  for (Index i = 0; i < count; ++i) {
    const Offsets alone{lengths.length(i)};
    CHECK(same_bits(ml::encode_tokens(encoder, ml::Sequences<B>(x[i], alone), 2, 0.1).rows, tokens[i]));
    CHECK(same_bits(encoder(ml::Sequences<B>(x[i], alone)).rows, rows[i]));
    CHECK(same_bits(decode(ml::slice(z, 0, i, i + 1), alone).rows, y[i]));
  }
  // All rows layer by layer, as if there were neither groups nor queries that are equal.
  auto all = ml::position_queries(decode.positions.rows(), lengths);
  for (const auto& layer : decode.seqTransDecoder.layers)
    all.rows = layer(all.rows, all.offsets, {z, Offsets::equal(count, 1)}, {});
  CHECK(same_bits(decode.final_layer(all).rows, y.rows));
  CHECK_ERROR(ml::encode_tokens(encoder, x, 7, 0.1), "[motionlang.shape.207]");
}

TEST_CASE("one row of memory: what attention gives, with its gradients") {
  ml::Philox rng{.seed = 8};
  const auto layer = ml::convert<A>(ml::MultiheadAttention<B>(8, 2, 0, rng));
  const auto x = normal<A, 2>({5, 8}, 9), memory = normal<A, 2>({2, 8}, 10);
  const Offsets offsets{3, 2};
  const auto weights = normal<B, 2>({5, 8}, 11);
  auto gradients = [&](const ml::Tensor<A, 2>& y) {
    return ml::backward(ml::sum(y * ml::Tensor<A, 2>::from(weights.to_vector(), weights.shape())));
  };
  const auto direct = ml::detail::attend_one_row(layer, memory, offsets, {});
  const auto general = layer.cross(x, offsets, {memory, Offsets{1, 1}}, {});
  CHECK(distance(direct, general) < 1e-14);
  const auto a = gradients(direct), b = gradients(general);
  CHECK(distance(a[layer.in_proj_weight], b[layer.in_proj_weight]) < 1e-14);
  CHECK(distance(a[layer.in_proj_bias], b[layer.in_proj_bias]) < 1e-14);
  CHECK(distance(a[memory], b[memory]) < 1e-14);
}

TEST_CASE("dropout: only with a generator; with one row of memory it drops whole heads") {
  const auto decode = decoder();
  const auto z = normal<B, 2>({2, 8}, 12);
  const Offsets lengths{3, 2};
  auto with = [&](std::uint64_t seed) { return decode(z, lengths, {.dropout = ml::Philox{.seed = seed}}).rows; };
  CHECK(same_bits(with(1), with(1)));
  CHECK_FALSE(same_bits(with(1), with(2)));
  CHECK_FALSE(same_bits(with(1), decode(z, lengths).rows));

  ml::Philox rng{.seed = 13};
  ml::MultiheadAttention<B> half(8, 2, 0.5, rng);
  std::vector<double> identity(64);
  for (std::size_t i = 0; i < 8; ++i) identity[9 * i] = 1;
  half.out_proj.weight = Matrix::from(identity, {8, 8});
  const auto plain = ml::detail::attend_one_row(half, z, Offsets{50, 50}, {}).to_vector();
  const auto dropped = ml::detail::attend_one_row(half, z, Offsets{50, 50}, {.dropout = ml::Philox{}}).to_vector();
  int zeros = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const bool zero = dropped[i] == 0;
    CHECK((zero || dropped[i] == doctest::Approx(2 * plain[i])));
    zeros += zero ? 1 : 0;
  }
  CHECK(zeros > 300);
  CHECK(zeros < 500);

  // Rows that keep the same heads are computed once: the same as row by row, gradients too.
  const auto layer = ml::convert<A>(ml::MultiheadAttention<B>(8, 2, 0.5, rng));
  const auto memory = normal<A, 2>({2, 8}, 14);
  const Offsets offsets{9, 5};
  const ml::Context context{.dropout = ml::Philox{.seed = 15}}, again{.dropout = ml::Philox{.seed = 15}};
  const auto mask = ml::next_dropout(0.5, again);
  std::vector<double> factors;
  for (std::uint64_t i = 0; i < 28; ++i) factors.push_back(mask.factor(i));
  const auto bias = ml::slice(layer.in_proj_bias, 0, 16, 24);
  const auto value =
      ml::repeat_for_rows(ml::linear(memory, ml::slice(layer.in_proj_weight, 0, 16, 24), &bias), offsets);
  const auto by_row = layer.out_proj(
      ml::reshape<2>(ml::reshape<2>(value, {28, 4}) * ml::Tensor<A, 2>::from(factors, {28, 1}), {14, 8}));
  const auto once = ml::detail::attend_one_row(layer, memory, offsets, context);
  CHECK(distance(once, by_row) < 1e-14);
  const auto a = ml::backward(ml::sum(once * once)), b = ml::backward(ml::sum(by_row * by_row));
  CHECK(distance(a[layer.in_proj_weight], b[layer.in_proj_weight]) < 1e-13);
  CHECK(distance(a[layer.out_proj.weight], b[layer.out_proj.weight]) < 1e-13);
  CHECK(distance(a[memory], b[memory]) < 1e-13);
}

TEST_CASE("the layers of a stack begin as copies, and are parameters of their own") {
  ml::Philox rng{.seed = 14};
  auto model = ml::copied_layers<ml::TransformerEncoder<A>>(small, rng);
  const auto &first = model.layers[0].linear1.weight, &second = model.layers[1].linear1.weight;
  CHECK(same_bits(first, second));
  const auto slopes = ml::backward(ml::sum(ml::square(first)));
  CHECK(distance(slopes[second], Matrix::zeros(second.shape())) == 0);
  CHECK(rng.position > 0);  // what is drawn next is something else
}
