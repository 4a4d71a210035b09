// What every module can do: tensors by path, counting, packing for inference. The laws are in tests/laws.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/nn/conv1d.hpp>
#include <motionlang/nn/linear.hpp>

#include "../../support/tensors.hpp"

#include <doctest/doctest.h>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

namespace {

struct Two {
  ml::Linear<B> first;
  std::vector<ml::Linear<B>> more;
  double eps = 0.5;
  static constexpr auto fields() { return ml::fields("first", &Two::first, "more", &Two::more, "eps", &Two::eps); }
};

}  // namespace

TEST_CASE("tensors are visited by path, options are passed over") {
  ml::Philox rng;
  Two two{{2, 3, rng}, {{3, 1, rng}}};
  std::vector<std::string> paths;
  ml::visit_tensors(two, [&](const std::string& path, const auto&) { paths.push_back(path); });
  CHECK(paths == std::vector<std::string>{"first.weight", "first.bias", "more.0.weight", "more.0.bias"});
  CHECK(ml::parameter_count(two) == 2 * 3 + 3 + 3 + 1);
  CHECK(ml::count_leaves(two) == 5);
}

TEST_CASE("packed weights give the same numbers, whatever the number of rows") {
  ml::Philox rng{.seed = 1};
  const ml::Linear<B> plain(70, 45, rng);
  auto packed = ml::convert<B>(plain);
  ml::prepare(packed);
  for (ml::Index rows : {1, 5, 64, 300}) {
    const auto x = tensors::normal<B, 2>({rows, 70}, 2);
    CHECK(tensors::same_bits(packed(x), plain(x)));
  }
}

TEST_CASE("a convolution of a prepared weight: the same bits, and the weight is still what it was") {
  ml::Philox rng{.seed = 1};
  for (const ml::Conv1dOptions o : {ml::Conv1dOptions{.padding = 1}, ml::Conv1dOptions{.stride = 2},
                                    ml::Conv1dOptions{.padding = 2, .dilation = 2}}) {
    for (ml::Index taps : {1, 3}) {
      const ml::Conv1d<B> plain(20, 45, taps, o, rng);
      auto packed = ml::convert<B>(plain);
      ml::prepare(packed);
      const ml::Sequences<B> x(tensors::normal<B, 2>({40, 20}, 2), ml::Offsets{15, 25});
      CHECK(tensors::same_bits(packed(x).rows, plain(x).rows));
      // a prepared weight of three axes, taken as the matrix that it is in memory
      const auto matrix = [&](const ml::Conv1d<B>& c) { return ml::reshape<2>(c.weight, {45, 20 * taps}); };
      const auto rows = tensors::normal<B, 2>({9, 20 * taps}, 3);
      CHECK(tensors::same_bits(ml::linear<B>(rows, matrix(packed), nullptr),
                               ml::linear<B>(rows, matrix(plain), nullptr)));
    }
  }
}
