// Losses by hand: values, gradients where they meet, filtered negatives, what is refused.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/loss/info_nce.hpp>
#include <motionlang/loss/kl.hpp>
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
  const auto each = ml::mse_per_sequence(a, b);
  CHECK(each.shape() == ml::Shape{2});
  CHECK(each.span()[0] == Approx(1));
  CHECK(each.span()[1] == Approx(8 / 6.0));
  CHECK_ERROR(ml::padded_mse(a, Matrix::zeros({4, 3})), "[motionlang.shape.202]");
}

TEST_CASE("the divergence is 0 for the standard normal, and positive elsewhere") {
  const auto zero = Matrix::zeros({2, 3});
  CHECK(ml::kl_to_standard_normal(zero, zero).item() == 0);
  CHECK(ml::kl_to_standard_normal(zero + 2.0, zero).item() == Approx(2));
  CHECK(ml::kl_to_standard_normal(zero, zero + 1.0).item() == Approx((std::exp(1.0) - 2) / 2));
  CHECK(ml::kl_to_standard_normal(zero, zero - 1.0).item() > 0);
}

TEST_CASE("InfoNCE: perfect pairs, no pairs, filtered negatives") {
  const auto x = Matrix::from({3, 0, 0, 0.1}, {2, 2});  // lengths do not matter
  CHECK(ml::info_nce(x, x, 0.1).item() == Approx(std::log(1 + std::exp(-10.0))));
  const auto equal = Matrix::full({2, 2}, 1);
  CHECK(ml::info_nce(x, equal, 0.5).item() == Approx(std::log(2.0)));
  const std::vector<std::vector<double>> same{{1, 0}, {1, 0}}, different{{1, 0}, {0, 1}};
  CHECK(ml::info_nce(x, equal, 0.5, &same).item() == Approx(0));  // the only negative says the same
  CHECK(ml::info_nce(x, equal, 0.5, &different).item() == Approx(std::log(2.0)));
  CHECK(std::isfinite(ml::info_nce(Matrix::zeros({2, 2}), x, 0.1).item()));
  CHECK_ERROR(ml::info_nce(x, Matrix::zeros({3, 2}), 0.1), "[motionlang.shape.204] info_nce");
  const std::vector<std::vector<double>> three(3);
  CHECK_ERROR(ml::info_nce(x, x, 0.1, &three), "[motionlang.shape.204]");
  const std::vector<std::vector<double>> ragged{{1, 0}, {1}};
  CHECK_ERROR(ml::info_nce(x, x, 0.1, &ragged), "[motionlang.shape.204] info_nce: sentences of 2 and 1 numbers");
  for (double temperature : {0.0, -0.1, std::nan("")})
    CHECK_ERROR(ml::info_nce(x, x, temperature), "[motionlang.config.101] info_nce: temperature");
}

TEST_CASE("InfoNCE: a softmax that vanishes in float still has a logarithm and a slope") {
  using A = ml::Autodiff<ml::EigenBackend<float>>;
  const auto x = ml::variable<A>(ml::Tensor<A::inner, 2>::from({1, 0, 0, 1}, {2, 2}));
  const auto swapped = ml::Tensor<A, 2>::from({0, 1, 1, 0}, {2, 2});
  const auto loss = ml::info_nce(x, swapped, 0.001);  // e^-1000 on the diagonal
  CHECK(loss.item() == Approx(1000));
  CHECK(ml::backward(loss)[x].to_vector() == std::vector<float>{0, -500, -500, 0});
}
