// Philox: known answers, streams, distributions.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <motionlang/core/context.hpp>

namespace ml = motionlang;
using ml::Philox;

TEST_CASE("the blocks are those of the reference implementation") {  // Random123, kat_vectors, philox 4x32 10
  CHECK(Philox{}.block(0) == Philox::Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
  constexpr std::uint64_t ones = ~std::uint64_t{0};
  CHECK(Philox{.seed = ones, .stream = ones}.block(ones) ==
        Philox::Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
  CHECK(Philox{.seed = 0x299f31d0a4093822, .stream = 0x0370734413198a2e}.block(0x85a308d3243f6a88) ==
        Philox::Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}

TEST_CASE("parts depend on seed, stream and name, not on what was drawn") {
  Philox a{.seed = 7}, b{.seed = 7};
  std::vector<double> drawn(100);
  a.normal(std::span<double>(drawn));
  const auto first = [](Philox g) { return g.bits(); };
  CHECK(first(a.split("noise")) == first(b.split("noise")));
  CHECK(first(a.split("noise")) != first(a.split("dropout")));
  CHECK(first(a.split("noise").split(3)) != first(a.split("noise").split(4)));
  CHECK(first(a.split("noise")) != first(Philox{.seed = 8}.split("noise")));
  CHECK(first(a.split("a").split("b")) != first(a.split("b").split("a")));
  std::set<std::uint64_t> streams;
  for (std::uint64_t i = 0; i < 10000; ++i) streams.insert(a.split(i).stream);
  CHECK(streams.size() == 10000);
}

TEST_CASE("the same numbers whatever the size of the request, in whole blocks") {
  std::vector<float> all(64), parts(64);
  Philox{.seed = 1}.normal(std::span<float>(all));
  Philox rng{.seed = 1};
  for (std::size_t i = 0; i < 64; i += 16) rng.normal(std::span<float>(parts).subspan(i, 16));
  CHECK(all == parts);
}

TEST_CASE("numbers from any place on are those that the whole list has there") {
  std::vector<float> normal(23), uniform(23);
  Philox{.seed = 1, .position = 3}.normal(std::span<float>(normal));
  Philox{.seed = 1, .position = 3}.uniform(std::span<float>(uniform));
  for (std::size_t first = 0; first < normal.size(); ++first) {
    for (std::size_t count = 1; first + count <= normal.size(); ++count) {
      std::vector<float> some(count);
      const auto of = [&](const std::vector<float>& all) { return std::equal(some.begin(), some.end(), &all[first]); };
      Philox rng{.seed = 1, .position = 3};
      rng.normal<float>(some, first);
      CHECK(of(normal));
      CHECK(rng.position == 3 + (first + count + 3) / 4);
      Philox{.seed = 1, .position = 3}.uniform<float>(some, first);
      CHECK(of(uniform));
    }
  }
}

TEST_CASE_TEMPLATE("normal numbers have mean 0, variance 1 and the right tails", S, float, double) {
  std::vector<S> z(200'001);  // not a multiple of a block
  Philox{.seed = 5}.normal(std::span<S>(z));
  double sum = 0, squares = 0, fourth = 0;
  int beyond = 0;
  for (S v : z) {
    const auto x = static_cast<double>(v);
    sum += x, squares += x * x, fourth += x * x * x * x, beyond += std::abs(x) > 1.959964;
  }
  const auto n = static_cast<double>(z.size());
  CHECK(std::abs(sum / n) < 0.01);
  CHECK(squares / n == doctest::Approx(1).epsilon(0.01));
  CHECK(fourth / n == doctest::Approx(3).epsilon(0.03));
  CHECK(beyond / n == doctest::Approx(0.05).epsilon(0.03));
}

TEST_CASE_TEMPLATE("uniform numbers lie in [0, 1) and spread evenly", S, float, double) {
  std::vector<S> u(100'003);
  Philox{.seed = 6}.uniform(std::span<S>(u));
  std::vector<int> bins(10);
  for (S v : u) {
    REQUIRE(v >= S(0));
    REQUIRE(v < S(1));
    ++bins[static_cast<std::size_t>(v * S(10))];
  }
  for (int count : bins) CHECK(count == doctest::Approx(10'000).epsilon(0.05));
}

TEST_CASE("below is even, reaches every number, and refuses 0") {
  Philox rng{.seed = 2};
  std::vector<int> bins(7);
  for (int i = 0; i < 70'000; ++i) ++bins[rng.below(7)];
  for (int count : bins) CHECK(count == doctest::Approx(10'000).epsilon(0.05));
  CHECK(rng.below(1) == 0);
  for (int i = 0; i < 100; ++i) CHECK(rng.below(0x80000001u) <= 0x80000000u);
  CHECK_THROWS_WITH_AS(rng.below(0), doctest::Contains("[motionlang.config.101]"), ml::config_error);
}

TEST_CASE("a context hands out another generator for every mask, and none unless asked") {
  CHECK_FALSE(ml::Context{}.dropout.has_value());
  const ml::Context c{.dropout = Philox{.seed = 1}};
  Philox first = c.next_mask(), second = c.next_mask();
  CHECK(first.bits() != second.bits());
  const ml::Context again{.dropout = Philox{.seed = 1}};
  CHECK(again.next_mask().stream == first.stream);
}
