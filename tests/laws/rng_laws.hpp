// SPDX-License-Identifier: MIT
/// Laws of Rng. g and h are equal generators; x = g(n) are n numbers that g draws:
///
///     equal         g(n) = h(n), also for a copy made in the middle
///     split         g.split(s) gives the same numbers before and after g has drawn, and drawing from it leaves g alone
///     range         uniform numbers lie in [0, 1)
///     independent   g.split(s) and g.split(t) differ if s and t do (not of NoInit, which is not random)
///
/// Laws of Shuffler: the list is permuted, equal generators permute alike, and lists of no or one element draw nothing.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include <motionlang/compose/sinc_assignment.hpp>
#include <motionlang/core/rng.hpp>

namespace laws {

namespace ml = motionlang;

template <class G>
requires ml::Rng<std::remove_cvref_t<G>> std::vector<float> drawn(G&& g, std::size_t n = 64) {
  std::vector<float> x(n);
  g.normal(std::span<float>(x));
  return x;
}

template <ml::Rng G>
void rng_laws(const G& seeded) {
  G g = seeded, h = seeded;
  CHECK(drawn(g) == drawn(h));
  G copy = g;
  CHECK(drawn(g) == drawn(copy));

  const auto by_name = drawn(seeded.split("noise")), by_number = drawn(seeded.split(std::uint64_t{7}));
  CHECK(drawn(g.split("noise")) == by_name);
  CHECK(drawn(g.split(std::uint64_t{7})) == by_number);
  G before = g;
  G part = g.split("noise");
  drawn(part, 1000);
  CHECK(drawn(g) == drawn(before));

  std::vector<float> u(1000);
  g.uniform(std::span<float>(u));
  CHECK(std::all_of(u.begin(), u.end(), [](float x) { return x >= 0 && x < 1; }));
}

template <ml::Rng G>
void independence_law(const G& g) {
  CHECK(drawn(g.split("noise")) != drawn(g.split("dropout")));
  CHECK(drawn(g.split(std::uint64_t{1})) != drawn(g.split(std::uint64_t{2})));
  CHECK(drawn(g.split("noise").split(std::uint64_t{1})) != drawn(g.split(std::uint64_t{1}).split("noise")));
  CHECK(drawn(g.split("noise")) != drawn(G(g)));
}

template <ml::Shuffler G>
void shuffler_laws(const G& seeded) {
  const auto shuffled = [](G& g, ml::Index n) {
    std::vector<ml::Index> list;
    for (ml::Index i = 0; i < n; ++i) list.push_back(i);
    g.shuffle(std::span<ml::Index>(list));
    return list;
  };
  for (ml::Index n : {0, 1, 2, 3, 50}) {
    G g = seeded, h = seeded;
    auto list = shuffled(g, n);
    CHECK(list == shuffled(h, n));
    std::sort(list.begin(), list.end());
    for (ml::Index i = 0; i < n; ++i) CHECK(list[static_cast<std::size_t>(i)] == i);
  }
  G g = seeded, h = seeded;
  shuffled(g, 0), shuffled(g, 1);
  CHECK(shuffled(g, 50) == shuffled(h, 50));
}

}  // namespace laws
