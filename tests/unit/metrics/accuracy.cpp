// Confusion and accuracy by hand.
#include <motionlang/metrics/accuracy.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index;

TEST_CASE("accuracy: rows are labels, equals go to the first class") {
  const std::vector<float> logits{1, 0, 0, 2, 1, 1, 0, 5};
  const std::vector<Index> labels{0, 0, 1, 1};
  const auto confusion = ml::confusion_matrix(ml::Rows(logits, 2), labels);
  CHECK(confusion == std::vector<Index>{1, 1, 1, 1});
  CHECK(ml::accuracy(confusion) == 0.5);
  CHECK(ml::accuracy(std::vector<Index>{7}) == 1);
  CHECK_ERROR(ml::confusion_matrix(ml::Rows(logits, 4), labels), "[motionlang.shape.204]");
  CHECK_ERROR(ml::confusion_matrix(ml::Rows(logits, 2), std::vector<Index>{0, 0, 1, 2}), "[motionlang.shape.203]");
  CHECK_ERROR(ml::accuracy(std::vector<Index>(3)), "[motionlang.shape.205]");
  CHECK_ERROR(ml::accuracy(std::vector<Index>(4)), "[motionlang.numeric.302]");
}

TEST_CASE("answer_accuracies: optional answers do not count") {
  const std::vector<double> predicted{1, 0, 0, 0, 1, 1}, wanted{1, 0.5, 1, 0, 0, 1}, wrong{1, 2, 1, 0, 0, 1};
  const auto a = ml::answer_accuracies(ml::Rows(predicted, 2), ml::Rows(wanted, 2));
  CHECK(a[0] == doctest::Approx(1.0 / 3));
  CHECK(a[1] == 1);
  CHECK_ERROR(ml::answer_accuracies(ml::Rows(predicted, 2), ml::Rows(wanted, 3)), "[motionlang.shape.204]");
  CHECK_ERROR(ml::answer_accuracies(ml::Rows(predicted, 2), ml::Rows(wanted, 2).slice(0, 2)), "[motionlang.shape.204]");
  CHECK_ERROR(ml::answer_accuracies(ml::Rows(predicted, 2), ml::Rows(wrong, 2)), "[motionlang.numeric.302]");
  CHECK_ERROR(ml::answer_accuracies(ml::Rows(predicted, 2).slice(0, 1), ml::Rows(wanted, 2).slice(0, 1)),
              "[motionlang.numeric.302]");
}
