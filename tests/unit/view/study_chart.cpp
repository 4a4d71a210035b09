// The counts of a study as bars.
#include <motionlang/view/study_chart.hpp>

#include <doctest/doctest.h>

namespace ml = motionlang;

TEST_CASE("pairs: items by majority in per cent, with the interval and a line in the middle") {
  const ml::Study study = ml::parse_study("text\tours\ttheirs\n1\tx\tx\n", ml::StudyKind::pairs);
  ml::StudyCounts counts;
  counts.pairs.push_back({.a = 0, .b = 1, .items = 4, .items_a = 2, .items_tied = 1, .items_b = 1});
  counts.pairs[0].preferred = ml::wilson_share(2.5, 4);
  const ml::BarChart chart = ml::study_chart(study, counts);
  REQUIRE(chart.groups.size() == 1);
  CHECK(chart.groups[0].name == "ours : theirs");
  CHECK(chart.groups[0].values == std::vector<double>{50, 25, 25});
  CHECK(chart.groups[0].low == doctest::Approx(100 * counts.pairs[0].preferred.low));
  CHECK(chart.groups[0].high == doctest::Approx(100 * counts.pairs[0].preferred.high));
  CHECK((chart.stacked && chart.mark == 50 && chart.series.size() == 3));
  CHECK(ml::bar_chart_svg(chart).find("ours : theirs") != std::string::npos);
}

TEST_CASE("rankings and ratings: the shares of ranks and of ratings") {
  const ml::Study ranking = ml::parse_study("text\ta\tb\n1\tx\tx\n", ml::StudyKind::ranking);
  ml::StudyCounts counts;
  counts.ranks.push_back({0, {3, 1}, {}});
  counts.ranks.push_back({1, {1, 3}, {}});
  const ml::BarChart ranks = ml::study_chart(ranking, counts);
  CHECK(ranks.series == std::vector<std::string>{"rank 1", "rank 2"});
  REQUIRE(ranks.groups.size() == 2);
  CHECK(ranks.groups[1].values == std::vector<double>{25, 75});
  counts.ratings.push_back({1, {0, 0, 0, 2, 2}, {}});
  const ml::Study rating = ml::parse_study("text\ta\tb\n1\tx\tx\n", ml::StudyKind::rating);
  const ml::BarChart ratings = ml::study_chart(rating, counts);
  REQUIRE(ratings.groups.size() == 1);
  CHECK(ratings.groups[0].name == "b");
  CHECK(ratings.groups[0].values == std::vector<double>{0, 0, 0, 50, 50});
  CHECK(ratings.mark < 0);
}
