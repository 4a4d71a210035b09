// Quantisation: the nearest code, of equals the first; gradients go past the choice; perplexity counts codes in use.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/nn/vector_quantizer.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::ReferenceBackend<double>;
using A = ml::Autodiff<B>;
using tensors::distance, tensors::normal;

TEST_CASE("the nearest code, of equals the first, whatever the length of the vectors") {
  ml::Philox rng;
  ml::VectorQuantizer<B> q(4, 2, 1, rng);
  q.embedding.weight = ml::Tensor<B, 2>::from({0, 0, 2, 0, 2, 0, 0, 100}, {4, 2});
  CHECK(q.codes(ml::Tensor<B, 2>::from({0.9, 0, 1.1, 0, 50, 0, 0, 51}, {4, 2})) == std::vector<Index>{0, 1, 1, 3});
  CHECK_ERROR(q.codes(ml::Tensor<B, 2>::zeros({1, 3})), "[motionlang.shape.201]");
}

TEST_CASE(
    "straight through: the numbers of the code, the gradient of the vector; each half of the loss moves one side") {
  ml::Philox rng{.seed = 2};
  const auto q = ml::convert<A>(ml::VectorQuantizer<B>(5, 3, 0.25, rng));
  const auto z = normal<A, 2>({4, 3}, 3);
  const auto out = q(z);
  CHECK(distance(out.straight_through, out.rows) < 1e-15);
  const auto weights = normal<B, 2>({4, 3}, 4);
  const auto constant = ml::Tensor<A, 2>::from(weights.to_vector(), {4, 3});
  const auto gradients = ml::backward(ml::sum(out.straight_through * constant));
  CHECK(distance(gradients[z], weights) < 1e-15);
  CHECK(gradients.find(q.embedding.weight.data()) == nullptr);
  const auto difference = ml::value_of(z) - ml::value_of(q(z).rows);
  const auto of_loss = ml::backward(q(z).loss);
  CHECK(distance(of_loss[z], difference * (2 * 0.25 / 12)) < 1e-14);
  CHECK(distance(ml::sum(of_loss[q.embedding.weight], 0), ml::sum(difference, 0) * (-2.0 / 12)) < 1e-14);
}

TEST_CASE("code_perplexity: all codes alike, one code only") {
  CHECK(ml::code_perplexity(std::vector<Index>{0, 1, 2, 3}, 4) == doctest::Approx(4).epsilon(1e-8));
  CHECK(ml::code_perplexity(std::vector<Index>{2, 2, 2}, 4) == doctest::Approx(1).epsilon(1e-8));
}
