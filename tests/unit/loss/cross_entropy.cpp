// The loss of classifiers: by hand, large scores, gradient, invalid labels.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/loss/cross_entropy.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index;
using A = ml::Autodiff<ml::ReferenceBackend<double>>;
using Matrix = ml::Tensor<A, 2>;

TEST_CASE("cross entropy: minus the mean logarithm of the right class's share") {
  const std::vector<Index> labels{1, 0};
  const auto s = Matrix::from({0, std::log(3.0), 5, 5}, {2, 2});
  CHECK(ml::cross_entropy(s, labels).item() == doctest::Approx((-std::log(0.75) - std::log(0.5)) / 2));
  CHECK(ml::cross_entropy(s + 1e4, labels).item() == doctest::Approx((-std::log(0.75) - std::log(0.5)) / 2));
  const std::vector<Index> unknown{1, 2}, few{1};
  CHECK_ERROR(ml::cross_entropy(s, unknown), "[motionlang.shape.203]");
  CHECK_ERROR(ml::cross_entropy(s, few), "[motionlang.shape.204]");
  const std::vector<Index> only{0, 0};
  CHECK(ml::cross_entropy(Matrix::from({3, -2}, {2, 1}), only, 0.1).item() == 0);  // one class: nothing to smooth
}

TEST_CASE("cross entropy: the gradient is (share - right) / rows") {
  const std::vector<Index> labels{2, 0};
  const auto s = tensors::normal<A, 2>({2, 3}, 1);
  const auto gradient = ml::backward(ml::cross_entropy(s, labels))[s];
  for (std::size_t i = 0; i < 2; ++i) {
    double total = 0;
    for (std::size_t j = 0; j < 3; ++j) total += std::exp(s.span()[3 * i + j]);
    for (std::size_t j = 0; j < 3; ++j) {
      const double right = static_cast<Index>(j) == labels[i] ? 1 : 0;
      CHECK(gradient.span()[3 * i + j] == doctest::Approx((std::exp(s.span()[3 * i + j]) / total - right) / 2));
    }
  }
}
