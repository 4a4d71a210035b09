// Losses by hand: values, gradients where they meet, filtered negatives, what is refused.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/loss/false_negatives.hpp>
#include <motionlang/loss/info_nce.hpp>
#include <motionlang/loss/kl.hpp>
#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/loss/margin.hpp>
#include <motionlang/loss/reconstruction.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<double>;
using Matrix = ml::Tensor<B, 2>;
using doctest::Approx;

TEST_CASE("squares and Huber's loss") {
  const auto a = Matrix::from({0, 0, 0, 0}, {2, 2}), b = Matrix::from({0.5, -0.5, 3, -1}, {2, 2});
  CHECK(ml::mse(a, b).item() == Approx((0.25 + 0.25 + 9 + 1) / 4));
  CHECK(ml::smooth_l1(a, b).item() == Approx((0.125 + 0.125 + 2.5 + 0.5) / 4));

  using A = ml::Autodiff<B>;
  const auto x = ml::variable<A>(b);
  const auto slope = ml::backward(ml::smooth_l1(x, ml::Tensor<A, 2>(0.0)))[x];
  CHECK(slope.to_vector() ==
        std::vector<double>{0.125, -0.125, 0.25, -0.25});  // d / 4 inside, sign / 4 outside and at 1
}

TEST_CASE("losses of sequences: padding counts in one, not in the other") {
  const ml::Sequences<B> a(Matrix::zeros({4, 2}), ml::Offsets{1, 3});
  const auto b = Matrix::from({1, 1, 2, 0, 0, 2, 0, 0}, {4, 2});
  CHECK(ml::padded_mse(a, b).item() == Approx((2 + 8) / 12.0));  // as if both had 3 frames
  CHECK(ml::padded_mse(a, b, 5).item() == Approx((2 + 8) / 20.0));
  CHECK(ml::padded_mse(a, b, 2).item() == Approx((2 + 8) / 12.0));
  const auto each = ml::mse_per_sequence(a, b);
  CHECK(each.shape() == ml::Shape{2});
  CHECK(each.span()[0] == Approx(1));
  CHECK(each.span()[1] == Approx(8 / 6.0));
  CHECK(ml::padded_smooth_l1(a, b).item() == Approx((0.5 + 0.5 + 1.5 + 1.5) / 12.0));
  CHECK(ml::padded_smooth_l1(a, b, 4).item() == Approx((0.5 + 0.5 + 1.5 + 1.5) / 16.0));
  // each on its own: (0.5 + 0.5) / 2 and (1.5 + 1.5) / 6
  CHECK(ml::smooth_l1_of_sequences(a, b).item() == Approx((0.5 + 0.5) / 2));
  CHECK_ERROR(ml::padded_mse(a, Matrix::zeros({4, 3})), "[motionlang.shape.202]");
}

TEST_CASE("the divergence is 0 for the standard normal, and positive elsewhere") {
  const auto zero = Matrix::zeros({2, 3});
  CHECK(ml::kl_to_standard_normal(zero, zero).item() == 0);
  CHECK(ml::kl_to_standard_normal(zero + 2.0, zero).item() == Approx(2));
  CHECK(ml::kl_to_standard_normal(zero, zero + 1.0).item() == Approx((std::exp(1.0) - 2) / 2));
  CHECK(ml::kl_to_standard_normal(zero, zero - 1.0).item() > 0);
}

TEST_CASE("the divergence of two Gaussians: against the standard normal, against numbers by hand, not symmetric") {
  const auto zero = Matrix::zeros({2, 3}), mu = zero + 0.7, logvar = zero - 0.4;
  CHECK(ml::kl_divergence(mu, logvar, zero, zero).item() == Approx(ml::kl_to_standard_normal(mu, logvar).item()));
  CHECK(ml::kl_divergence(mu, logvar, mu, logvar).item() == 0);
  // N(1, 4) and N(3, 16): ln 2 + (4 + 4) / 32 - 1/2
  const auto wide = zero + std::log(16.0), narrow = zero + std::log(4.0);
  CHECK(ml::kl_divergence(zero + 1.0, narrow, zero + 3.0, wide).item() == Approx(std::log(2.0) - 0.25));
  CHECK(ml::kl_divergence(zero + 3.0, wide, zero + 1.0, narrow).item() == Approx(2.5 - 0.5 - std::log(2.0)));
}

TEST_CASE("the divergences of rows, whose mean is that of all") {
  const auto zero = Matrix::zeros({2, 3});
  const auto mu = Matrix::from({1, 1, 1, 3, 3, 3}, {2, 3});
  const auto rows = ml::kl_to_standard_normal_of_rows(mu, zero);
  CHECK(rows.to_vector() == std::vector<double>{0.5, 4.5});
  CHECK(ml::mean(rows).item() == Approx(ml::kl_to_standard_normal(mu, zero).item()));
  CHECK(ml::kl_divergence_of_rows(mu, zero, zero + 1.0, zero).to_vector() == std::vector<double>{0, 2});
}

TEST_CASE("named terms: the total weighs them, parts are picked by name") {
  ml::LossTerms<B> terms;
  CHECK(terms.total().item() == 0);
  terms.add("kl_text", 0.5, ml::Tensor<B, 0>(4));
  terms.add("kl_motion", 0.25, ml::Tensor<B, 0>(8));
  terms.add("recons", 1, ml::Tensor<B, 0>(1));
  CHECK(terms.total().item() == 5);
  CHECK(terms.sum_of("kl_").item() == 12);
  ml::LossTerms<B> both;
  both.append(terms, "_0");
  both.append(terms);
  CHECK(both.terms[2].name == "recons_0");
  CHECK(both.terms[3].name == "kl_text");
  CHECK(both.total().item() == 10);
}

TEST_CASE("InfoNCE: perfect pairs, no pairs, filtered negatives") {
  const auto x = Matrix::from({3, 0, 0, 0.1}, {2, 2});  // lengths do not matter
  CHECK(ml::info_nce(x, x, 0.1).item() == Approx(std::log(1 + std::exp(-10.0))));
  const auto equal = Matrix::full({2, 2}, 1);
  CHECK(ml::info_nce(x, equal, 0.5).item() == Approx(std::log(2.0)));
  const auto filtered = [](std::vector<double> sentences, double threshold) {
    return ml::false_negatives(Matrix::from(sentences, {2, 2}), threshold);
  };
  const std::vector<double> same{1, 0, 1, 0}, different{1, 0, 0, 1};
  CHECK(ml::info_nce(x, equal, 0.5, filtered(same, 0.8)).item() == Approx(0));  // the only negative says the same
  CHECK(ml::info_nce(x, equal, 0.5, filtered(different, 0.8)).item() == Approx(std::log(2.0)));
  CHECK(ml::info_nce(x, equal, 0.5, filtered(same, 0)).item() == Approx(std::log(2.0)));
  CHECK(ml::info_nce(x, equal, 0.5, filtered(different, 0.4)).item() ==
        Approx(0));  // cosines above -0.2, except the diagonal
  CHECK(std::isfinite(ml::info_nce(Matrix::zeros({2, 2}), x, 0.1).item()));
  // strangers join the sums over x of each y, which now have three equal terms; the sums over y have two
  const auto stranger = Matrix::from({5, 5}, {1, 2});
  CHECK(ml::info_nce(equal, equal, 0.5, {}, &stranger).item() == Approx((std::log(2.0) + std::log(3.0)) / 2));
  const auto behind = Matrix::from({-1, -1}, {1, 2});  // far from every y
  CHECK(ml::info_nce(equal, equal, 0.05, {}, &behind).item() == Approx(std::log(2.0)));
  CHECK_ERROR(ml::info_nce(x, Matrix::zeros({3, 2}), 0.1), "[motionlang.shape.204] info_nce");
  const std::vector<unsigned char> three(3);
  CHECK_ERROR(ml::info_nce(x, x, 0.1, three), "[motionlang.shape.205] info_nce: a filter of 3 pairs for a batch of 2");
  CHECK_ERROR(filtered(same, 1.5), "[motionlang.config.101] false_negatives: threshold 1.5");
  CHECK_ERROR(filtered({1, 0, 3, 4}, 0.8), "[motionlang.numeric.302] false_negatives: sentence 1 has length 5, not 1");
  CHECK(filtered({0, 0, 1, 0}, 0.8) == std::vector<unsigned char>(4));  // a text without words
  CHECK_ERROR(filtered({std::nan(""), 0, 1, 0}, 0.8), "[motionlang.numeric.302]");
  for (double temperature : {0.0, -0.1, std::nan("")})
    CHECK_ERROR(ml::info_nce(x, x, temperature), "[motionlang.config.101] info_nce: temperature");
}

TEST_CASE("InfoNCE: the filter is strict and symmetric") {
  const auto t = Matrix::from({1, 0, 0.6, 0.8, 0.8, 0.6}, {3, 2});  // cosines 0.6, 0.8, 0.96; 0.8 stands for 0.6
  CHECK(ml::false_negatives(t, 0.8) == std::vector<unsigned char>{0, 0, 1, 0, 0, 1, 1, 1, 0});
  CHECK(ml::false_negatives(t, 0).empty());
}

TEST_CASE("InfoNCE: a learned temperature has a gradient") {
  using A = ml::Autodiff<B>;
  const auto x = ml::Tensor<A, 2>::from({1, 0, 0.6, 0.8}, {2, 2}), y = ml::Tensor<A, 2>::from({0.8, 0.6, 0, 1}, {2, 2});
  const auto at = [&](double log_temperature) {
    const auto t = ml::variable<A>(ml::Tensor<B, 0>(log_temperature));
    const auto loss = ml::info_nce(x, y, exp(t));
    return std::pair{static_cast<double>(loss.item()), ml::backward(loss)[t].item()};
  };
  const double h = 1e-6;
  CHECK(at(-1).second == Approx((at(-1 + h).first - at(-1 - h).first) / (2 * h)).epsilon(1e-7));
  CHECK(at(-1).first == Approx(ml::info_nce(x, y, std::exp(-1.0)).item()));
}

TEST_CASE("the margin loss pulls pairs together and pushes others as far as the margin") {
  const auto x = Matrix::from({0, 0, 3, 4}, {2, 2});
  CHECK(ml::margin_loss(x, x, 4).item() == Approx(0).epsilon(1e-9));  // the others are 5 away
  CHECK(ml::margin_loss(x, x, 7).item() == Approx(4).epsilon(1e-5));
  CHECK(ml::margin_loss(x, x + 1.0, 1e-3).item() == Approx(2).epsilon(1e-5));
  const std::vector<unsigned char> all(4, 1);
  CHECK(ml::margin_loss(x, x, 7, all).item() == Approx(0).epsilon(1e-9));
  CHECK_ERROR(ml::margin_loss(x, Matrix::zeros({3, 2})), "[motionlang.shape.204] margin_loss");
  CHECK_ERROR(ml::margin_loss(x, x, 0), "[motionlang.config.101] margin_loss: margin 0");
  CHECK_ERROR(ml::margin_loss(x, x, 1, std::vector<unsigned char>(3)), "[motionlang.shape.205] margin_loss");

  using A = ml::Autodiff<B>;
  const auto v = ml::variable<A>(x);
  const auto slopes = ml::backward(ml::margin_loss(v, ml::Tensor<A, 2>::from({0, 0, 0, 0}, {2, 2}), 6.0));
  for (double s : slopes[v].to_vector()) CHECK(std::isfinite(s));  // also where two rows meet
}

TEST_CASE("InfoNCE: a softmax that vanishes in float still has a logarithm and a slope") {
  using A = ml::Autodiff<ml::EigenBackend<float>>;
  const auto x = ml::variable<A>(ml::Tensor<A::inner, 2>::from({1, 0, 0, 1}, {2, 2}));
  const auto swapped = ml::Tensor<A, 2>::from({0, 1, 1, 0}, {2, 2});
  const auto loss = ml::info_nce(x, swapped, 0.001);  // e^-1000 on the diagonal
  CHECK(loss.item() == Approx(1000));
  CHECK(ml::backward(loss)[x].to_vector() == std::vector<float>{0, -500, -500, 0});
}
