// Tensors as text.
#include <sstream>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/tensor/print.hpp>

#include <doctest/doctest.h>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
template <int R>
using Tensor = ml::Tensor<B, R>;

TEST_CASE("a tensor as text: shape, and numbers in brackets") {
  CHECK(to_string(Tensor<0>(0.1)) == "() 0.1");
  CHECK(to_string(Tensor<1>::from({1, -2.5, 1e-9F}, {3})) == "(3) [1, -2.5, 1e-09]");
  CHECK(to_string(Tensor<2>::from({1, 2, 3, 4}, {2, 2})) ==
        "(2, 2) [[1, 2],\n"
        "        [3, 4]]");
  CHECK(to_string(Tensor<3>::from({1, 2, 3, 4}, {2, 2, 1})) ==
        "(2, 2, 1) [[[1],\n"
        "            [2]],\n"
        "\n"
        "           [[3],\n"
        "            [4]]]");
  CHECK(to_string(Tensor<2>::zeros({0, 3})) == "(0, 3) []");
  CHECK(to_string(Tensor<2>::zeros({2, 0})) == "(2, 0) [[],\n        []]");
  CHECK(to_string(Tensor<2>()) == "no tensor");
  CHECK(to_string(ml::Tensor<ml::EigenBackend<double>, 0>(0.1)) == "() 0.1");
}

TEST_CASE("large tensors are shown by their ends") {
  std::vector<float> numbers(2000);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<float>(i);
  CHECK(to_string(Tensor<1>::from(numbers, {2000})) == "(2000) [0, 1, 2, ..., 1997, 1998, 1999]");
  CHECK(to_string(Tensor<2>::from(numbers, {1000, 2})) ==
        "(1000, 2) [[0, 1],\n"
        "           [2, 3],\n"
        "           [4, 5],\n"
        "           ...,\n"
        "           [1994, 1995],\n"
        "           [1996, 1997],\n"
        "           [1998, 1999]]");
  numbers.resize(1000);
  CHECK(to_string(Tensor<1>::from(numbers, {1000})).find("...") == std::string::npos);
}

TEST_CASE("a tensor goes into a stream") {
  std::ostringstream out;
  out << Tensor<1>::from({1, 2}, {2}) << '!';
  CHECK(out.str() == "(2) [1, 2]!");
}
