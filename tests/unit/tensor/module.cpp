// Functions of every module: tensors by path, counting, packing for inference. The laws are in tests/laws.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/nn/conv1d.hpp>
#include <motionlang/nn/linear.hpp>

#include "../../support/check_error.hpp"
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

TEST_CASE("tensors are visited by path, options are skipped") {
  ml::Philox rng;
  Two two{{2, 3, rng}, {{3, 1, rng}}};
  std::vector<std::string> paths;
  ml::visit_tensors(two, [&](const std::string& path, const auto&) { paths.push_back(path); });
  CHECK(paths == std::vector<std::string>{"first.weight", "first.bias", "more.0.weight", "more.0.bias"});
  CHECK(ml::parameter_count(two) == 2 * 3 + 3 + 3 + 1);
  CHECK(ml::count_leaves(two) == 5);
}

TEST_CASE("a layer that was moved from is refused; it can be assigned to") {
  ml::Philox rng;
  ml::Linear<B> layer(2, 3, rng);
  const auto x = tensors::normal<B, 2>({4, 2}, 1);
  const auto before = layer(x);
  auto taken = std::move(layer);
  CHECK_ERROR(layer(x), "[motionlang.shape.201] linear: inner sizes differ: input (4, 2), weight (0)");  // NOLINT
  CHECK(ml::parameter_count(layer) == 0);
  CHECK(tensors::same_bits(taken(x), before));
  layer = std::move(taken);
  CHECK(tensors::same_bits(layer(x), before));
  ml::Sequences<B> sequences(x, ml::Offsets{1, 3});
  const auto kept = std::move(sequences);
  CHECK(kept.count() == 2);
  CHECK(sequences.rows.shape() == ml::Shape{0});  // NOLINT
  CHECK_ERROR(layer(sequences), "[motionlang.shape.201]");
}

namespace {

/// Names that the compiler cannot look at.
struct SameNames {
  ml::Tensor<B, 1> a, b;
  static auto fields() { return ml::fields("a", &SameNames::a, "a", &SameNames::b); }
};
/// One of two optional members is there, under the same name.
struct OneOfTwo {
  std::optional<ml::Linear<B>> map;
  std::optional<ml::LinearMap<B>> other;
  static constexpr auto fields() { return ml::fields("map", &OneOfTwo::map, "map", &OneOfTwo::other); }
};
struct Sizes {
  static constexpr bool is_option = true;
  int width = 3;
};
struct WithSizes {
  Sizes sizes;
  ml::Tensor<B, 1> a;
  static constexpr auto fields() { return ml::fields("sizes", &WithSizes::sizes, "a", &WithSizes::a); }
};

}  // namespace

TEST_CASE("two members of one name are refused; a type may say that it holds no tensors") {
  const SameNames same{ml::Tensor<B, 1>::zeros({1}), ml::Tensor<B, 1>::zeros({1})};
  CHECK_ERROR(ml::parameter_count(same),
              "[motionlang.config.102] fields() of a module lists two members by the name 'a'");
  ml::Philox rng;
  OneOfTwo one;
  one.other = ml::LinearMap<B>(2, 3, rng);
  CHECK(ml::parameter_count(one) == 6);
  CHECK(ml::parameter_count(WithSizes{{}, ml::Tensor<B, 1>::zeros({4})}) == 4);
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
