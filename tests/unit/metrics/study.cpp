// Perceptual studies: tables, the order of trials, and files of answers.
#include <motionlang/metrics/study.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <set>

namespace ml = motionlang;

namespace {

const char* const pairs_table =
    "# motions of two models and a recording\n"
    "role\ttext\tours\ttheirs\treal\n"
    "warmup\trun\ta0.bvh\tb0.bvh\n"
    "\twalk\ta1.bvh\tb1.bvh\tc1.bvh\n"
    "\n"
    "\tjump\t a2.bvh \tb2.bvh\t\n"
    "catch real\tsit\ta3.bvh\tb3.bvh\tc3.bvh\n";

std::string hex(std::uint64_t x) {
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(x));
  return text;
}
std::string answers_of(const ml::Study& study, const std::string& lines, const char* seed = "7") {
  return "study\t" + hex(study.fingerprint) + "\nkind\t" + to_string(study.kind) + "\nseed\t" + seed +
         "\nrater\tAnn\ntrial\tanswer\tseconds\n" + lines;
}

}  // namespace

TEST_CASE("a table of a study: roles, texts and the choices of each system") {
  const ml::Study study = ml::parse_study(pairs_table, ml::StudyKind::pairs);
  CHECK(study.systems == std::vector<std::string>{"ours", "theirs", "real"});
  REQUIRE(study.items.size() == 4);
  CHECK(study.items[0].role == ml::StudyRole::warmup);
  CHECK(study.items[1].role == ml::StudyRole::counted);
  CHECK(study.items[1].text == "walk");
  CHECK(study.items[2].choices == std::vector<std::string>{"a2.bvh", "b2.bvh", ""});
  CHECK(study.items[3].role == ml::StudyRole::catch_trial);
  CHECK(study.items[3].right == 2);
  CHECK(!study.ranks_texts);
  CHECK(study.fingerprint != ml::parse_study(pairs_table, ml::StudyKind::ranking).fingerprint);
  const ml::Study texts =
      ml::parse_study("motion\ttimeline\ta\tb\nm.bvh\tt.txt\twalks\truns\n", ml::StudyKind::ranking);
  CHECK(texts.ranks_texts);
  CHECK(texts.items[0].motion == "m.bvh");
  CHECK(texts.items[0].timeline == "t.txt");
  for (const char* name : {"pairs", "ranking", "rating"}) CHECK(to_string(ml::parse_study_kind(name)) == name);
  CHECK_THROWS_WITH_AS(ml::parse_study_kind("votes"), doctest::Contains("103"), ml::config_error);
}

TEST_CASE("tables that cannot be a study") {
  const auto refused = [](const char* table, const char* why, ml::StudyKind kind = ml::StudyKind::pairs) {
    CHECK_THROWS_WITH_AS(ml::parse_study(table, kind, "s.tsv"), doctest::Contains(why), ml::io_error);
  };
  refused("", "no line below");
  refused("text\ta\tb\n", "no line below");
  refused("text\ta\nwalk\ta.bvh\n", "s.tsv:1: the columns have 1 system");
  refused("text\n", "0 systems", ml::StudyKind::rating);
  refused("a\ta\n", "column 'a' is not a new name");
  refused("a\tb\nx\ty\tz\n", "s.tsv:2: 3 cells below 2 columns");
  refused("a\tb\nx\t\n", "s.tsv:2: 1 choice to compare");
  refused("role\ta\tb\ncatch c\tx\ty\n", "role 'catch c'");
  refused("role\ta\tb\tc\ncatch c\tx\ty\n", "the right answer has no choice");
  refused("motion\ta\tb\n\tx\ty\n", "no motion");
}

TEST_CASE("trials: warm-ups first, all pairs, another order for another seed") {
  const ml::Study study = ml::parse_study(pairs_table, ml::StudyKind::pairs);
  const auto trials = ml::study_trials(study, 7);
  CHECK(trials == ml::study_trials(study, 7));
  REQUIRE(trials.size() == 1 + 3 + 1 + 2);  // the catch trial has no pair without its right system
  CHECK(trials[0].item == 0);
  CHECK(ml::describe_trials(study, trials) == "4 trials, 1 warm-up and 2 catch trials");
  std::multiset<std::pair<std::size_t, std::set<int>>> seen;
  for (const auto& t : trials) seen.insert({t.item, {t.shown.begin(), t.shown.end()}});
  const std::multiset<std::pair<std::size_t, std::set<int>>> expected{
      {0, {0, 1}}, {1, {0, 1}}, {1, {0, 2}}, {1, {1, 2}}, {2, {0, 1}}, {3, {0, 2}}, {3, {1, 2}}};
  CHECK(seen == expected);
  // Every order of sides and of trials comes up.
  std::set<std::size_t> second;
  std::set<int> left;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto drawn = ml::study_trials(study, seed);
    CHECK(drawn[0].item == 0);
    second.insert(drawn[1].item);
    left.insert(drawn[0].shown[0]);
  }
  CHECK(second == std::set<std::size_t>{1, 2, 3});
  CHECK(left == std::set<int>{0, 1});
  for (const auto& t : ml::study_trials(ml::parse_study(pairs_table, ml::StudyKind::ranking), 1))
    CHECK(t.shown.size() == (t.item == 1 || t.item == 3 ? 3 : 2));
  CHECK(ml::study_trials(ml::parse_study(pairs_table, ml::StudyKind::rating), 1).size() == 2 + 3 + 2 + 3);
}

TEST_CASE("answers: places, no preference, ratings; the last answer to a trial counts") {
  const ml::Study pairs = ml::parse_study(pairs_table, ml::StudyKind::pairs);
  const auto read = ml::parse_study_answers(answers_of(pairs, "0\t1\t2.5\n3\t-\t1\n0\t0\t4\n"), pairs);
  CHECK(read.rater == "Ann");
  CHECK(read.seed == 7);
  REQUIRE(read.answers.size() == 2);
  CHECK(read.answers[0].places.empty());
  CHECK(read.answers[1].trial == 0);
  CHECK(read.answers[1].places == std::vector<int>{0});
  CHECK(read.answers[1].seconds == 4);
  const ml::Study rating = ml::parse_study(pairs_table, ml::StudyKind::rating);
  CHECK(ml::parse_study_answers(answers_of(rating, "2\t5\t1\n"), rating).answers[0].rating == 5);

  const auto refused = [](const ml::Study& study, const std::string& text, const char* why) {
    CHECK_THROWS_WITH_AS(ml::parse_study_answers(text, study, "ann.tsv"), doctest::Contains(why), ml::io_error);
  };
  refused(pairs, "", "ann.tsv: no answers");
  refused(pairs, "trial\tanswer\tseconds\n", "no study or no seed");
  refused(pairs, answers_of(rating, ""), "answers to another study");
  refused(pairs, answers_of(pairs, "", "x"), "seed 'x'");
  refused(pairs, answers_of(pairs, "9\t0\t1\n"), "ann.tsv:6: a line has a trial below 7");
  for (const char* wrong : {"abc", "", "nan", "inf", "-1", "2,5", "2.5 s", "1e999"})
    refused(pairs, answers_of(pairs, std::string("0\t1\t") + wrong + "\n"), "is not a number of seconds");
  CHECK(ml::parse_study_answers(answers_of(pairs, "0\t1\t0\n"), pairs).answers[0].seconds == 0);
  refused(pairs, answers_of(pairs, "0\t2\t1\n"), "'2' does not answer");
  refused(pairs, answers_of(pairs, "0\t0,1\t1\n"), "'0,1' does not answer");
  refused(rating, answers_of(rating, "0\t6\t1\n"), "'6' does not answer");
  const ml::Study ranking = ml::parse_study(pairs_table, ml::StudyKind::ranking);
  CHECK(ml::parse_study_answers(answers_of(ranking, "0\t1,0\t1\n"), ranking).answers[0].places ==
        std::vector<int>{1, 0});
  for (const char* wrong : {"0", "0,0", "-", "0,2"})
    refused(ranking, answers_of(ranking, std::string("0\t") + wrong + "\t1\n"), "does not answer");
}
