// What every module can do: tensors by path, counting, packing for inference. The laws are in tests/laws.
#include <motionlang/backend/eigen.hpp>
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
