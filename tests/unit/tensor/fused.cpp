// Fused operations: what is refused, and the edges that the table of tests/ops does not have.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/fused.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Offsets;

TEST_CASE_TEMPLATE("shapes are checked before a kernel runs", B, ml::EigenBackend<float>, ml::ReferenceBackend<float>) {
  using Matrix = ml::Tensor<B, 2>;
  using Vector = ml::Tensor<B, 1>;
  const auto x = Matrix::zeros({5, 6}), weight = Matrix::zeros({4, 6}), wrong = Matrix::zeros({5, 5});
  const auto bias = Vector::zeros({4}), six = Vector::zeros({6});
  CHECK_ERROR(ml::linear(wrong, weight, &bias), "[motionlang.shape.201] linear: inner sizes differ: input (5, 5)");
  CHECK_ERROR(ml::linear(x, weight, &six), "[motionlang.shape.204] linear: bias (6) for weight (4, 6)");
  CHECK_ERROR(ml::linear(x, weight, &bias, ml::Activation::none, &wrong), "[motionlang.shape.204] linear: residual");
  CHECK_ERROR(ml::layer_norm(x, bias, six), "[motionlang.shape.204] layer_norm");
  CHECK_ERROR(ml::add_layer_norm(x, x, six, bias), "[motionlang.shape.204]");

  const Offsets whole{5};
  CHECK_ERROR(ml::attention(x, wrong, wrong, whole, whole, {}), "[motionlang.shape.204] attention");
  CHECK_ERROR(ml::attention(x, x, x, whole, Offsets{4}, {}), "[motionlang.shape.207] attention: offsets");
  CHECK_ERROR(ml::attention(x, x, x, whole, Offsets{2, 3}, {}), "[motionlang.shape.207]");
  CHECK_ERROR(ml::attention(x, x, x, Offsets{2, 3}, Offsets{5, 0}, {}), "sequence 1 has no keys");
  CHECK_ERROR(ml::attention(x, x, x, whole, whole, {.heads = 4}), "[motionlang.config.101] attention: 4 heads");
  CHECK_ERROR(ml::attention(x, x, x, whole, whole, {.heads = 0}), "[motionlang.config.101]");
  const auto near = Matrix::zeros({1, 7}), even = Matrix::zeros({1, 10}), heads = Matrix::zeros({2, 9});
  for (const auto* scores : {&near, &even, &heads})
    CHECK_ERROR(ml::attention(x, x, x, whole, whole, {}, scores), "[motionlang.shape.204] attention: relative scores");
  CHECK_ERROR(ml::self_attention(wrong, whole, {}), "[motionlang.shape.204] self_attention");
  CHECK_ERROR(ml::self_attention(x, Offsets{6}, {}), "[motionlang.shape.207]");
  CHECK_ERROR(ml::self_attention(x, whole, {.heads = 3}), "[motionlang.config.101]");
  CHECK_ERROR(ml::dropout(x, {.p = 1}), "[motionlang.config.101] dropout: probability 1");
  CHECK_ERROR(ml::dropout(x, {.p = -0.1}), "[motionlang.config.101]");
}

TEST_CASE_TEMPLATE("zero rows need no work", B, ml::EigenBackend<float>, ml::ReferenceBackend<float>) {
  using Matrix = ml::Tensor<B, 2>;
  const auto none = Matrix::zeros({0, 6});
  CHECK(ml::linear<B>(none, Matrix::zeros({4, 6}), nullptr).shape() == ml::Shape{0, 4});
  CHECK(ml::softmax(none).shape() == ml::Shape{0, 6});
  CHECK(ml::attention(none, none, none, Offsets{0, 0}, Offsets{0, 0}, {}).shape() == ml::Shape{0, 6});
  const auto x = tensors::normal<B, 2>({3, 6}, 1);
  const auto some = ml::attention(x, x, x, Offsets{0, 3, 0}, Offsets{0, 3, 0}, {.heads = 2});
  CHECK(tensors::same_bits(some, ml::attention(x, x, x, Offsets{3}, Offsets{3}, {.heads = 2})));
}

TEST_CASE_TEMPLATE("dropout keeps the expected share and scales it up", B, ml::EigenBackend<float>,
                   ml::ReferenceBackend<float>) {
  const auto ones = ml::Tensor<B, 2>::full({100, 100}, 1);
  const auto dropped = ml::dropout(ones, {.p = 0.25, .key = 9});
  int kept = 0;
  for (float v : dropped.span()) {
    CHECK((v == 0 || v == doctest::Approx(1 / 0.75)));
    kept += v != 0;
  }
  CHECK(kept == doctest::Approx(7500).epsilon(0.03));
  CHECK(tensors::same_bits(ml::dropout(ones, {.p = 0.25, .key = 9}), dropped));
  CHECK_FALSE(tensors::same_bits(ml::dropout(ones, {.p = 0.25, .key = 10}), dropped));
  CHECK(tensors::same_bits(ml::dropout(ones, {.p = 0, .key = 9}), ones));
}

TEST_CASE("names of activations") {
  CHECK(ml::parse_activation("gelu") == ml::Activation::gelu);
  CHECK(ml::parse_activation("identity") == ml::Activation::none);
  CHECK_ERROR(ml::parse_activation("GELU"), "[motionlang.config.103]");
}
