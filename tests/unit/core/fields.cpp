// Member lists: visiting, zipping, paths.
#include <doctest/doctest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <motionlang/core/fields.hpp>

namespace ml = motionlang;

namespace {

template <class Leaf>
struct Linear {
  Leaf weight{}, bias{};
  static constexpr auto fields() { return ml::fields("weight", &Linear::weight, "bias", &Linear::bias); }
};

template <class Leaf>
struct Network {
  Linear<Leaf> in;
  std::vector<Linear<Leaf>> layers;
  std::optional<Linear<Leaf>> extra;
  std::vector<Leaf> tables;
  std::optional<Leaf> scale;
  static constexpr auto fields() {
    using N = Network;
    return ml::fields("in.0", &N::in, "layers", &N::layers, "extra", &N::extra, "tables", &N::tables, "scale",
                      &N::scale);
  }
};

struct Empty {
  static constexpr auto fields() { return ml::fields(); }
};

static_assert(ml::Module<Network<int>> && ml::Module<Empty> && !ml::Module<int>);

std::vector<std::string> paths(const auto& module) {
  std::vector<std::string> out;
  ml::visit(module, [&](const std::string& path, const auto&) { out.push_back(path); });
  return out;
}

}  // namespace

TEST_CASE("paths follow the order of the fields; elements are numbered; what is absent is left out") {
  Network<int> n{.in = {1, 2}, .layers = {{3, 4}, {5, 6}}, .extra = {}, .tables = {7}, .scale = {}};
  CHECK(paths(n) == std::vector<std::string>{"in.0.weight", "in.0.bias", "layers.0.weight", "layers.0.bias",
                                             "layers.1.weight", "layers.1.bias", "tables.0"});
  n.extra.emplace();
  n.scale = 1;
  CHECK(paths(n).size() == 10);
  CHECK(paths(n)[6] == "extra.weight");
  CHECK(paths(n)[9] == "scale");
  CHECK(ml::count_leaves(n) == 10);
  CHECK(ml::count_leaves(Empty{}) == 0);
}

TEST_CASE("leaves can be changed, and read only if the module is const") {
  Network<int> n{.in = {1, 2}, .layers = {{3, 4}}, .extra = {}, .tables = {}, .scale = 5};
  ml::visit(n, [](const std::string&, auto& leaf) { leaf *= 10; });
  CHECK(n.in.bias == 20);
  CHECK(n.layers[0].weight == 30);
  CHECK(n.scale == 50);
  const auto& view = n;
  ml::visit(view, [](const std::string&, auto& leaf) {
    static_assert(std::is_const_v<std::remove_reference_t<decltype(leaf)>>);
  });
}

TEST_CASE("zip walks over two modules of one structure, also of other leaves") {
  Network<int> a{.in = {1, 2}, .layers = {{3, 4}}, .extra = {}, .tables = {}, .scale = 5};
  Network<std::string> b{.in = {"a", "b"}, .layers = {{"c", "d"}}, .extra = {}, .tables = {}, .scale = "e"};
  std::string seen;
  ml::zip(a, b, [&](const std::string&, int i, const std::string& s) { seen += std::to_string(i) + s; });
  CHECK(seen == "1a2b3c4d5e");

  b.layers.emplace_back();
  CHECK_THROWS_WITH_AS(ml::zip(a, b, [](const auto&...) {}),
                       doctest::Contains("[motionlang.shape.204] zip: numbers of layers differ: 1, 2"),
                       ml::shape_error);
  b.layers.pop_back();
  b.scale.reset();
  CHECK_THROWS_WITH_AS(ml::zip(a, b, [](const auto&...) {}),
                       doctest::Contains("[motionlang.shape.204] zip: only one side has scale"), ml::shape_error);
}
