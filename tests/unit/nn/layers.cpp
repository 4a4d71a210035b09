// Layers: small cases by hand, shapes, what is refused.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/nn/dropout.hpp>
#include <motionlang/nn/embedding.hpp>
#include <motionlang/nn/gru.hpp>
#include <motionlang/nn/layer_norm.hpp>
#include <motionlang/nn/linear_attention.hpp>
#include <motionlang/nn/positional_encoding.hpp>
#include <motionlang/nn/text_features.hpp>
#include <motionlang/nn/timestep_embedding.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::EigenBackend<double>;
using Matrix = ml::Tensor<B, 2>;
using Values = std::vector<double>;
using tensors::distance, tensors::normal, tensors::same_bits;

TEST_CASE("linear: any leading axes, activation, residual") {
  ml::Linear<B> layer;
  layer.weight = Matrix::from({1, 2, 3, -4}, {2, 2});
  layer.bias = ml::Tensor<B, 1>::from({10, 0}, {2});
  const auto x = Matrix::from({1, 1, 0, 1}, {2, 2});
  CHECK(layer(x).to_vector() == Values{13, -1, 12, -4});
  CHECK(layer(x, ml::Activation::relu).to_vector() == Values{13, 0, 12, 0});
  CHECK(layer(x, ml::Activation::none, &x).to_vector() == Values{14, 0, 12, -3});
  CHECK_ERROR(layer(x, ml::Activation::none, &x, {.p = 1}), "[motionlang.config.101] dropout: probability 1");
  CHECK(layer(ml::reshape<3>(x, {2, 1, 2})).to_vector() == Values{13, -1, 12, -4});
  CHECK(layer(ml::Tensor<B, 1>::from({1, 1}, {2})).to_vector() == Values{13, -1});
  CHECK(layer(ml::Sequences<B>(x, Offsets{1, 1})).offsets == Offsets{1, 1});
  CHECK(layer.in() == 2);
  CHECK_ERROR(layer(Matrix::zeros({1, 3})), "[motionlang.shape.201]");
  CHECK_ERROR(layer(ml::Tensor<B, 3>::zeros({1, 1, 3})), "[motionlang.shape.201]");
}

TEST_CASE("initial values: bounds of PyTorch, variables on a tape") {
  ml::Philox rng{.seed = 1};
  const ml::Linear<B> layer(25, 400, rng);
  double largest = 0;
  for (double w : layer.weight.span()) largest = std::max(largest, std::abs(w));
  CHECK(largest <= 0.2);
  CHECK(largest > 0.199);
  const auto glorot = ml::xavier_uniform<B>({30, 120}, rng);
  for (double w : glorot.span()) CHECK(std::abs(w) <= 0.2);
  const ml::Linear<ml::Autodiff<B>> taped(2, 3, rng);
  CHECK(taped.weight.data().node != nullptr);
  ml::NoInit zeros;
  CHECK(ml::Linear<B>(2, 1, zeros).bias.item() == 0);
  CHECK(ml::Linear<ml::Autodiff<B>>(2, 1, zeros).weight.data().node != nullptr);
}

TEST_CASE("embeddings pick rows; a symbol that does not exist is refused") {
  ml::Philox rng{.seed = 1};
  const ml::Embedding<B> e(5, 3, rng);
  const std::vector<Index> ids{4, 0, 4};
  CHECK(same_bits(ml::slice(e(ids), 0, 0, 1), ml::slice(e.weight, 0, 4, 5)));
  CHECK(e(ids).shape() == ml::Shape{3, 3});
  const std::vector<Index> beyond{5};
  CHECK_ERROR(e(beyond), "[motionlang.shape.203]");
}

TEST_CASE("one-hot rows of labels; how far a frame is through its sequence") {
  const std::vector<Index> labels{2, 0}, beyond{3}, negative{-1};
  CHECK(ml::one_hot<B>(labels, 3).to_vector() == Values{0, 0, 1, 1, 0, 0});
  CHECK_ERROR(ml::one_hot<B>(beyond, 3), "[motionlang.shape.203]");
  CHECK_ERROR(ml::one_hot<B>(negative, 3), "[motionlang.shape.203]");
  CHECK(ml::relative_time<B>(Offsets{3, 1, 0, 2}).to_vector() == Values{0, 0.5, 1, 0, 0, 1});
}

TEST_CASE("layer norm of a residual is the norm of the sum") {
  const ml::LayerNorm<B> norm(4);
  const auto x = normal<B, 2>({3, 4}, 1), r = normal<B, 2>({3, 4}, 2);
  CHECK(distance(norm(x, r), norm(x + r)) < 1e-14);
  CHECK(norm(Matrix::full({1, 4}, 7)).to_vector() == Values(4, 0));  // eps keeps a constant row finite
}

TEST_CASE("positions: the table, rows beyond it, gaps") {
  const auto table = ml::sinusoidal_positions<B>(10, 4);
  CHECK(ml::slice(table, 0, 0, 1).to_vector() == Values{0, 1, 0, 1});
  CHECK(table.span()[4] == doctest::Approx(std::sin(1.0)).epsilon(1e-6));
  CHECK(table.span()[7] == doctest::Approx(std::cos(0.01)).epsilon(1e-6));
  // Rounded from double, which gives these bits with glibc and musl. The float functions of glibc 2.36 miss them by one
  // unit.
  const auto wide = ml::sinusoidal_positions<B>(8, 256);
  CHECK(wide.span()[256 + 42] == 0x1.c047b2p-3f);
  CHECK(wide.span()[2 * 256 + 11] == 0x1.64d89cp-3f);
  CHECK(wide.span()[7 * 256 + 4] == -0x1.c1cd76p-3f);
  CHECK_ERROR(ml::sinusoidal_positions<B>(10, 5), "[motionlang.config.101]");
  // Figures of torch.exp (1.13, float): the third is one unit above the correctly rounded number, the fourth one below.
  CHECK(ml::torch_exp(0) == 1);
  const float infinity = std::numeric_limits<float>::infinity();
  CHECK(std::isnan(ml::torch_exp(std::numeric_limits<float>::quiet_NaN())));
  CHECK(ml::torch_exp(infinity) == infinity);
  CHECK(ml::torch_exp(200) == infinity);
  CHECK(ml::torch_exp(-infinity) == 0);
  CHECK(ml::torch_exp(-200) == 0);
  CHECK(ml::torch_exp(-0x1.26bb1cp-4f) == 0x1.dc73fp-1f);
  CHECK(ml::torch_exp(-0x1.def00ep-1f) == 0x1.91d648p-2f);
  CHECK(ml::torch_exp(-0x1.01e3b8p+0f) == 0x1.75f034p-2f);

  const ml::Sequences<B> zeros(Matrix::zeros({5, 4}), Offsets{2, 3});
  const auto with = ml::add_positions(zeros, table);
  CHECK(same_bits(with[1], ml::slice(table, 0, 0, 3)));
  const std::vector<ml::PositionGap> gaps{{1, 4}, {}};
  const auto moved = ml::add_positions(zeros, table, gaps);
  CHECK(same_bits(ml::slice(moved[0], 0, 1, 2), ml::slice(table, 0, 5, 6)));
  CHECK(same_bits(moved[1], with[1]));
  CHECK_ERROR(ml::add_positions(zeros, table, std::span(gaps).first(1)), "[motionlang.shape.204] add_positions");
  const ml::Sequences<B> longer(Matrix::zeros({11, 4}), Offsets{11});
  CHECK_ERROR(ml::add_positions(longer, table), "[motionlang.shape.203] add_positions: a sequence of");
}

TEST_CASE("step embeddings: one row for each step, equal steps alike") {
  ml::Philox rng{.seed = 1};
  const ml::TimestepEmbedding<B> e(6, rng);
  const auto table = ml::sinusoidal_positions<B>(10, 6);
  const std::vector<Index> t{3, 7, 3}, beyond{10};
  const auto rows = e(table, t);
  CHECK(rows.shape() == ml::Shape{3, 6});
  CHECK(same_bits(ml::slice(rows, 0, 0, 1), ml::slice(rows, 0, 2, 3)));
  CHECK_ERROR(e(table, beyond), "[motionlang.shape.203]");
}

TEST_CASE("a GRU with closed gates keeps its state, and one with open gates forgets it") {
  ml::Philox rng{.seed = 1};
  ml::GruLayer<B> layer(2, 3, rng);
  const auto h0 = normal<B, 2>({4, 3}, 2);
  const std::vector<Matrix> x(5, normal<B, 2>({4, 2}, 3));
  const auto gate = [&](double z) {  // rows r, z, n
    layer.bias_ih = ml::Tensor<B, 1>::from({0, 0, 0, z, z, z, 0, 0, 0}, {9});
    return layer(x, h0);
  };
  CHECK(distance(gate(50).back(), h0) < 1e-12);
  const auto forgets = gate(-50);
  CHECK(distance(forgets[1], h0) > 0.1);
  const auto other = layer(x, h0 * 0.0);
  CHECK(distance(forgets.front(), other.front()) > 1e-3);  // r lets the old state into the candidate
  CHECK(layer(std::vector<Matrix>{}, h0).empty());
  CHECK(ml::gru_key("gru.layers.2.weight_ih") == "gru.weight_ih_l2");
  CHECK(ml::gru_key("embed_text.weight") == "embed_text.weight");
}

TEST_CASE("linear attention: constant values stay, keys in any order") {
  const auto q = normal<B, 2>({3, 4}, 1), k = normal<B, 2>({5, 4}, 2), v = normal<B, 2>({5, 4}, 3);
  const Offsets queries{3}, keys{5};
  CHECK(distance(ml::linear_attention(q, k, Matrix::full({5, 4}, 2), queries, keys, 2), Matrix::full({3, 4}, 2)) <
        1e-14);
  const std::vector<Index> order{3, 1, 4, 0, 2};
  CHECK(distance(ml::linear_attention(q, ml::gather(k, order), ml::gather(v, order), queries, keys, 2),
                 ml::linear_attention(q, k, v, queries, keys, 2)) < 1e-14);
  CHECK_ERROR(ml::linear_attention(q, k, v, queries, keys, 3), "[motionlang.config.101]");
  const auto none = Matrix::zeros({0, 4});
  CHECK(ml::linear_attention(none, none, none, Offsets{}, Offsets{}, 2).size(0) == 0);
}

TEST_CASE("dropout needs a generator, and every mask of a call is another") {
  const auto x = Matrix::full({50, 50}, 1);
  CHECK(same_bits(ml::dropout(x, 0.5, ml::Context{}), x));
  const ml::Context context{.dropout = ml::Philox{.seed = 1}};
  const auto first = ml::dropout(x, 0.5, context), second = ml::dropout(x, 0.5, context);
  CHECK_FALSE(same_bits(first, x));
  CHECK_FALSE(same_bits(first, second));
  CHECK(same_bits(ml::dropout(x, 0, context), x));
}
