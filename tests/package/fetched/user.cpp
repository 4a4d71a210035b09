// SPDX-License-Identifier: MIT
// All packages in one unit, with all of our warnings as errors: none comes from a package that was fetched.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>
#include <CLI/CLI.hpp>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/tensor/ops.hpp>

namespace ml = motionlang;

template <ml::Backend B>
bool multiplies() {
  const auto product = ml::matmul(ml::Tensor<B, 2>::full({2, 3}, 2), ml::Tensor<B, 2>::full({3, 4}, 0.5));
  return product.shape() == ml::Shape{2, 4} && product.span()[7] == 3;
}

int main(int argc, char** argv) {
  CLI::App app("packages");
  CLI11_PARSE(app, argc, argv);
  const doctest::Context context;
  const bool json = ml::parse_json("{\"a\": [1, 2]}", "text").at("a").size() == 2;
  return json && multiplies<ml::EigenBackend<float>>() && multiplies<ml::XtensorBackend<double>>() ? 0 : 1;
}
