// Counts of a perceptual study, by hand: majorities, ties, ranks, ratings, intervals, raters who fail catch trials.
#include <motionlang/metrics/study_counts.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace ml = motionlang;

namespace {

/// The answers of a rater who judges by the systems; gives the systems in the order of preference. None: no preference.
ml::StudyAnswers by(const ml::Study& study, const char* name, std::uint64_t seed,
                    const std::function<std::vector<int>(const ml::StudyItem&)>& judge) {
  ml::StudyAnswers out{name, seed, {}};
  const auto trials = ml::study_trials(study, seed);
  for (std::size_t t = 0; t < trials.size(); ++t) {
    ml::StudyAnswer answer{.trial = t, .places = {}, .rating = 0, .seconds = 1};
    const auto wanted = judge(study.items[trials[t].item]);
    if (study.kind == ml::StudyKind::rating) {
      answer.rating = wanted[static_cast<std::size_t>(trials[t].shown[0])];
    } else {
      for (const int system : wanted) {
        const auto place = std::find(trials[t].shown.begin(), trials[t].shown.end(), system);
        if (place == trials[t].shown.end()) continue;
        answer.places.push_back(static_cast<int>(place - trials[t].shown.begin()));
        if (study.kind == ml::StudyKind::pairs) break;
      }
    }
    out.answers.push_back(answer);
  }
  return out;
}

const char* const table =
    "role\ttext\ta\tb\n"
    "warmup\tw\tx\tx\n"
    "\t1\tx\tx\n\t2\tx\tx\n\t3\tx\tx\n\t4\tx\tx\n"
    "catch b\tc\tx\tx\n";

std::vector<int> prefers(const ml::StudyItem& item, const std::string& for_a) {
  if (item.right >= 0) return {item.right};
  if (item.role == ml::StudyRole::warmup) return {0};
  return {for_a.find(item.text) != std::string::npos ? 0 : 1};
}

}  // namespace

TEST_CASE("pairs: the majority of each item, ties count half, warm-ups and bad raters not at all") {
  const ml::Study study = ml::parse_study(table, ml::StudyKind::pairs);
  const std::vector<ml::StudyAnswers> answers{
      by(study, "Ann", 1, [](const ml::StudyItem& i) { return prefers(i, "12"); }),
      by(study, "Bob", 2, [](const ml::StudyItem& i) { return prefers(i, "13"); }),
      by(study, "Eve", 3, [](const ml::StudyItem&) { return std::vector<int>{0}; }),  // always a, also where b is right
      by(study, "Joe", 4, [](const ml::StudyItem& i) {
        return i.right >= 0 ? std::vector<int>{i.right} : i.text == "4" ? std::vector<int>{} : prefers(i, "1");
      })};
  const ml::StudyCounts counts = ml::count_study(study, answers);
  REQUIRE(counts.raters.size() == 4);
  CHECK((counts.raters[0].kept && counts.raters[1].kept && !counts.raters[2].kept && counts.raters[3].kept));
  CHECK(counts.raters[2].caught == 1);
  CHECK(counts.raters[2].passed == 0);
  CHECK(counts.raters_for_item == 3);
  CHECK(ml::describe_raters(counts, std::vector<std::string>{"a.txt", "b.txt", "e.txt", "j.txt"}) ==
        "left out: Eve (e.txt), 0 of 1 catch trial passed\n3 of 4 raters kept, 3.0 answers for each trial\n");
  REQUIRE(counts.pairs.size() == 1);
  const ml::PairCount& p = counts.pairs[0];
  CHECK((p.a == 0 && p.b == 1 && p.items == 4));
  // Item 1: a a a; 2: a b b; 3: b a b; 4: b b none.
  CHECK((p.votes_a == 5 && p.votes_none == 1 && p.votes_b == 6));
  CHECK((p.items_a == 1 && p.items_tied == 0 && p.items_b == 3));
  CHECK(p.preferred.share == 0.25);
  // Without Joe the items 2 and 3 are ties.
  const ml::PairCount two = ml::count_study(study, std::span(answers).first(2)).pairs[0];
  CHECK((two.items_a == 1 && two.items_tied == 2 && two.items_b == 1));
  CHECK(two.preferred.share == 0.5);
  CHECK(two.preferred_or_similar.share == 0.75);
  // Everybody is kept if no catch trial has to be passed.
  CHECK(ml::count_study(study, answers, 0).raters[2].kept);
  // A rater who answered no catch trial is not kept.
  ml::StudyAnswers few = answers[0];
  few.answers.resize(1);
  CHECK(!ml::count_study(study, std::span(&few, 1)).raters[0].kept);
  CHECK(ml::count_study(study, {}).pairs.empty());
}

TEST_CASE("Wilson's interval") {
  const ml::StudyShare half = ml::wilson_share(5, 10);
  CHECK(half.share == 0.5);
  CHECK(half.low == doctest::Approx(0.2366).epsilon(0.001));
  CHECK(half.high == doctest::Approx(0.7634).epsilon(0.001));
  const ml::StudyShare none = ml::wilson_share(0, 20);
  CHECK(none.low == 0);
  CHECK(none.high == doctest::Approx(1.96 * 1.96 / (20 + 1.96 * 1.96)));
  const ml::StudyShare empty = ml::wilson_share(0, 0);
  CHECK((empty.share == 0 && empty.low == 0 && empty.high == 1));
}

TEST_CASE("ranking: how often each system has each rank, and its mean") {
  const ml::Study study = ml::parse_study("text\ta\tb\tc\n1\tx\tx\tx\n2\tx\tx\tx\n", ml::StudyKind::ranking);
  const std::vector<ml::StudyAnswers> answers{
      by(study, "Ann", 1,
         [](const ml::StudyItem&) {
           return std::vector<int>{2, 0, 1};
         }),
      by(study, "Bob", 2, [](const ml::StudyItem& i) {
        return i.text == "1" ? std::vector<int>{2, 1, 0} : std::vector<int>{0, 2, 1};
      })};
  const ml::StudyCounts counts = ml::count_study(study, answers);
  REQUIRE(counts.ranks.size() == 3);
  CHECK(counts.ranks[0].places == std::vector<std::size_t>{1, 2, 1});
  CHECK(counts.ranks[1].places == std::vector<std::size_t>{0, 1, 3});
  CHECK(counts.ranks[2].places == std::vector<std::size_t>{3, 1, 0});
  CHECK(counts.ranks[2].share(0) == 0.75);
  CHECK_THROWS_WITH_AS(counts.ranks[2].share(counts.ranks[2].places.size()),
                       doctest::Contains("[motionlang.shape.203] RankCount::share: place "), ml::shape_error);
  CHECK_THROWS_AS(ml::RankCount{}.share(0), ml::shape_error);
  // Item 1 of a: ranks 2 and 3; item 2: 2 and 1. Their means are 2.5 and 1.5.
  CHECK(counts.ranks[0].rank.mean == 2);
  CHECK(counts.ranks[0].rank.half_width == doctest::Approx(1.96 * 0.5 / std::sqrt(2.0)));
  CHECK(counts.raters_for_item == 2);
  CHECK(counts.pairs.empty());
}

TEST_CASE("rating: means of agreement, and a catch trial with a right and a wrong motion") {
  const ml::Study study =
      ml::parse_study("role\ttext\ta\tb\n\t1\tx\tx\n\t2\tx\tx\ncatch a\tc\tx\tx\n", ml::StudyKind::rating);
  const auto good = by(study, "Ann", 1, [](const ml::StudyItem& i) {
    return i.right >= 0 ? std::vector<int>{4, 2} : i.text == "1" ? std::vector<int>{5, 3} : std::vector<int>{4, 1};
  });
  const auto careless = by(study, "Bob", 2, [](const ml::StudyItem&) { return std::vector<int>{4, 3}; });
  const std::vector<ml::StudyAnswers> both{good, careless};
  const ml::StudyCounts counts = ml::count_study(study, both);
  CHECK(counts.raters[0].kept);
  CHECK(!counts.raters[1].kept);  // 3 for the wrong motion
  CHECK((counts.raters[1].caught == 2 && counts.raters[1].passed == 1));
  CHECK(ml::count_study(study, both, 0.5).raters[1].kept);
  REQUIRE(counts.ratings.size() == 2);
  CHECK(counts.ratings[0].rating.mean == 4.5);
  CHECK(counts.ratings[1].rating.mean == 2);
  CHECK(counts.ratings[0].ratings == std::array<std::size_t, 5>{0, 0, 0, 1, 1});
}

TEST_CASE("counts are a table of their kind") {
  ml::Study study;
  study.systems = {"ours", "theirs"};
  ml::StudyCounts counts;
  counts.pairs = {{.a = 0,
                   .b = 1,
                   .items = 4,
                   .votes_a = 5,
                   .votes_none = 1,
                   .votes_b = 6,
                   .items_a = 1,
                   .items_tied = 1,
                   .items_b = 2,
                   .preferred = {0.375, 0.1, 0.8},
                   .preferred_or_similar = {0.5, 0.2, 0.75}}};
  counts.ranks = {{.system = 1, .places = {3, 1}, .rank = {1.25, 0.5}}};
  counts.ratings = {{.system = 0, .ratings = {0, 1, 2, 3, 4}, .rating = {4, 0.125}}};
  const auto table = [&](ml::StudyKind kind) {
    study.kind = kind;
    const std::string out = ml::study_table(study, counts);
    const auto columns = std::count(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(out.find('\n')), '|');
    for (std::size_t at = 0; at < out.size(); at = out.find('\n', at) + 1)
      CHECK(std::count(out.begin() + static_cast<std::ptrdiff_t>(at),
                       out.begin() + static_cast<std::ptrdiff_t>(out.find('\n', at)), '|') == columns);
    return out;
  };
  CHECK(
      table(ml::StudyKind::pairs)
          .ends_with("\n| ours | theirs | 4 | 5 / 1 / 6 | 1 / 1 / 2 | 37.5 (10.0 to 80.0) | 50.0 (20.0 to 75.0) |\n"));
  CHECK(table(ml::StudyKind::ranking).ends_with("\n| theirs | 1.25 +- 0.50 | 75.0 | 25.0 |\n"));
  CHECK(table(ml::StudyKind::rating).ends_with("\n| ours | 4.00 +- 0.12 | 0 | 1 | 2 | 3 | 4 |\n"));
}
