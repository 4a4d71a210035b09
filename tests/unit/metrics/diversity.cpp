// Draws of pairs and the mean distance of them.
#include <algorithm>
#include <set>

#include <motionlang/metrics/diversity.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using doctest::Approx;
using ml::Index;

TEST_CASE("mean_pair_distance: by hand") {
  const std::vector<double> x{0, 0, 3, 4, 6, 8};
  const ml::Rows rows(x, 2);
  CHECK(ml::mean_pair_distance(rows, {{0, 0}, {1, 2}}) == Approx(7.5));
  CHECK(ml::mean_pair_distance(rows, {{1}, {1}}) == 0);
  CHECK_ERROR(ml::mean_pair_distance(rows, {{0}, {1, 2}}), "[motionlang.shape.204]");
  CHECK_ERROR(ml::mean_pair_distance(rows, {{0}, {3}}), "[motionlang.shape.203]");
  CHECK_ERROR(ml::mean_pair_distance(rows, {}), "[motionlang.numeric.302]");
}

TEST_CASE("draws: as many as asked for, disjoint where they have to be") {
  ml::NumpyRandom rng(1);
  const auto pairs = ml::random_pairs(3, 50, rng);
  CHECK(pairs.first.size() == 50);
  CHECK(*std::max_element(pairs.second.begin(), pairs.second.end()) == 2);
  const auto apart = ml::disjoint_draws(10, 9, rng);
  CHECK(std::set<Index>(apart.first.begin(), apart.first.end()).size() == 9);
  CHECK(std::set<Index>(apart.second.begin(), apart.second.end()).size() == 9);
  CHECK_ERROR(ml::disjoint_draws(10, 10, rng), "[motionlang.config.101]");
  CHECK_ERROR(ml::random_pairs(0, 1, rng), "[motionlang.config.101]");
}

TEST_CASE("pairs_within_classes: the quota of every class, equal labels") {
  const std::vector<Index> labels{0, 1, 1, 2, 2, 2, 2};
  ml::NumpyRandom rng(5);
  const auto pairs = ml::pairs_within_classes(labels, 3, 4, rng);
  std::array<int, 3> count{};
  for (std::size_t i = 0; i < pairs.first.size(); ++i) {
    const auto a = labels[static_cast<std::size_t>(pairs.first[i])];
    CHECK(a == labels[static_cast<std::size_t>(pairs.second[i])]);
    ++count[static_cast<std::size_t>(a)];
  }
  CHECK(count == std::array<int, 3>{4, 4, 4});
  CHECK_ERROR(ml::pairs_within_classes(labels, 4, 4, rng), "[motionlang.numeric.302]");
  CHECK_ERROR(ml::pairs_within_classes(labels, 2, 4, rng), "[motionlang.shape.203]");
  CHECK_ERROR(ml::pairs_within_classes(labels, 3, 0, rng), "[motionlang.config.101]");
}

TEST_CASE("multimodality: inside each text, not across them") {
  const std::vector<double> x{0, 1, 100, 103};  // two texts, two repeats each
  CHECK(ml::multimodality(ml::Rows(x, 1), 2, {{0}, {1}}) == Approx(2));
  CHECK_ERROR(ml::multimodality(ml::Rows(x, 1), 3, {{0}, {1}}), "[motionlang.shape.205]");
  CHECK_ERROR(ml::multimodality(ml::Rows(x, 1), 2, {{0}, {2}}), "[motionlang.shape.203]");
  CHECK_ERROR(ml::multimodality(ml::Rows(std::vector<double>{}, 1), 2, {{0}, {1}}), "[motionlang.numeric.302]");
}
