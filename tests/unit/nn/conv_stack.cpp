// Stacks of convolutions: the transposed one is the adjoint, steps keep PyTorch's numbers, training and use of norms.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/nn/conv_stack.hpp>
#include <motionlang/nn/conv_transpose1d.hpp>
#include <motionlang/nn/leaky_relu.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::ReferenceBackend<double>;
using Matrix = ml::Tensor<B, 2>;
using tensors::distance, tensors::normal, tensors::same_bits;

TEST_CASE("conv_transpose1d is the adjoint of conv1d: <conv x, y> = <x, conv^T y>, each sequence by itself") {
  for (const auto& [stride, padding, kernel] : {std::array<Index, 3>{2, 1, 4}, {1, 0, 3}, {3, 0, 3}}) {
    const auto weight = normal<B, 3>({5, 3, kernel}, 1);  // conv1d: (out, in, kernel), its adjoint: (in, out, kernel)
    const ml::Sequences<B> y(normal<B, 2>({7, 5}, 2), Offsets{4, 3});
    const auto up = ml::conv_transpose1d(y, weight, ml::Tensor<B, 1>::zeros({3}), stride, padding);
    const ml::Sequences<B> x(normal<B, 2>({up.offsets.rows(), 3}, 3), up.offsets);
    const auto down = ml::conv1d<B>(x, weight, nullptr, {.stride = stride, .padding = padding});
    REQUIRE(down.offsets == y.offsets);
    CHECK(ml::sum(down.rows * y.rows).item() == doctest::Approx(ml::sum(x.rows * up.rows).item()).epsilon(1e-12));
    const auto alone =
        ml::conv_transpose1d(ml::Sequences<B>(y[1], Offsets{3}), weight, ml::Tensor<B, 1>::zeros({3}), stride, padding);
    CHECK(same_bits(alone.rows, up[1]));
  }
  ml::Philox rng;
  const ml::ConvTranspose1d<B> conv(5, 3, 4, 2, 1, rng);
  CHECK(conv(ml::Sequences<B>(Matrix::zeros({7, 5}), Offsets{7})).offsets.length(0) == 14);
  CHECK_ERROR(conv(ml::Sequences<B>(Matrix::zeros({7, 4}), Offsets{7})), "[motionlang.shape.201]");
  CHECK_ERROR(conv(ml::Sequences<B>(Matrix::zeros({7, 5}), Offsets{7, 0})), "[motionlang.shape.205]");
}

TEST_CASE("leaky_relu") {
  const auto y = ml::leaky_relu(ml::Tensor<B, 1>::from({-2, 0, 3}, {3}), 0.2).to_vector();
  CHECK(y[0] == doctest::Approx(-0.4));
  CHECK(y[1] == 0);
  CHECK(y[2] == 3);
}

TEST_CASE("repeat_rows lengthens every sequence") {
  const ml::Sequences<B> x(Matrix::from({1, 2, 3}, {3, 1}), Offsets{2, 1});
  const auto y = ml::repeat_rows(x, 2);
  CHECK(y.offsets == Offsets{4, 2});
  CHECK(y.rows.to_vector() == std::vector<double>{1, 1, 2, 2, 3, 3});
}

TEST_CASE("a stack numbers its steps, keeps no numbers where there is nothing to learn, and trains its norms") {
  ml::Philox rng{.seed = 4};
  ml::ConvStack<B> stack;
  stack.conv(2, 3, 4, {.stride = 2, .padding = 1}, rng).norm(3).leaky_relu().residual(3, rng).repeat(2);
  std::vector<std::string> names;
  ml::visit_tensors(stack, [&](const std::string& path, const auto&) { names.push_back(path); });
  CHECK(names == std::vector<std::string>{"0.weight", "0.bias", "1.weight", "1.bias", "1.running_mean", "1.running_var",
                                          "1.num_batches_tracked", "3.model.0.weight", "3.model.0.bias",
                                          "3.model.2.weight", "3.model.2.bias"});
  const ml::Sequences<B> x(normal<B, 2>({8, 2}, 5), Offsets{8});
  const auto before = stack(x);
  CHECK(before.offsets == Offsets{8});
  CHECK(same_bits(std::as_const(stack)(x).rows, before.rows));  // use changes nothing
  const auto trained = stack.train(x);
  CHECK(distance(trained.rows, before.rows) > 1e-3);   // statistics of the batch
  CHECK(distance(stack(x).rows, before.rows) > 1e-6);  // and they are remembered
}

TEST_CASE("dropout of a stack runs only with a generator") {
  ml::ConvStack<B> stack;
  stack.dropout(0.5);
  const ml::Sequences<B> x(Matrix::full({64, 1}, 1), Offsets{64});
  CHECK(same_bits(stack(x).rows, x.rows));
  CHECK(distance(stack(x, {.dropout = ml::Philox{.seed = 1}}).rows, x.rows) > 0.4);
}
