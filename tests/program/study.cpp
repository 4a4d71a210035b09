// motionlang study and study-count: a page for raters, and what they answered.
#include <doctest/doctest.h>

#include <motionlang/formats/bvh.hpp>
#include <motionlang/metrics/study.hpp>

#include "../support/synthetic_motion.hpp"
#include "small_workplace.hpp"

namespace {

const char* const table =
    "role\ttext\ttimeline\tours\ttheirs\n"
    "warmup\twalk\t\ta.bvh\tb.bvh\n"
    "\twalk\ttwo.txt\ta.bvh\tb.bvh\n"
    "\tturn\t\tb.bvh\ta.bvh\n"
    "catch ours\tstand\t\ta.bvh\tb.bvh\n";

struct StudyWorkplace : Workplace {
  StudyWorkplace() {
    ml::write_bvh(*this / "a.bvh", synthetic::walk({.frames = 30}));
    ml::write_bvh(*this / "b.bvh", synthetic::walk({.frames = 20, .turn = 1}));
    ml::write_file(*this / "study.tsv", std::string_view(table));
  }
  /// The file of a rater who always prefers a system.
  void answer(const std::string& file, int system, const std::string& page) const {
    const ml::Study study = ml::parse_study(table, ml::StudyKind::pairs);
    const auto at = page.find("\"study\":\"") + 9;
    std::string text =
        "study\t" + page.substr(at, 16) + "\nkind\tpairs\nseed\t5\nrater\t" + file + "\ntrial\tanswer\tseconds\n";
    const auto trials = ml::study_trials(study, 5);
    for (std::size_t t = 0; t < trials.size(); ++t)
      text += std::to_string(t) + "\t" + (trials[t].shown[0] == system ? "0" : "1") + "\t1.0\n";
    ml::write_file(*this / file, text);
  }
};

}  // namespace

TEST_CASE("study, study-count: pairs with a catch trial") {
  const StudyWorkplace w;
  const Outcome made = w.run({"study", "study.tsv", "-o", "study.html", "--seed", "5", "--no-preference"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  CHECK_MESSAGE(contains(made.text, "study.html: 2 trials, 1 warm-up and 1 catch trial, seed 5"), made.text);
  const std::string page = ml::read_file(w / "study.html");
  CHECK(contains(page, "raise both arms"));  // of the timeline
  CHECK(!contains(page, "theirs"));
  w.answer("ann.tsv", 0, page);
  w.answer("bob.tsv", 1, page);
  const Outcome counted = w.run({"study-count", "study.tsv", "ann.tsv", "bob.tsv"});
  REQUIRE_MESSAGE(counted.code == 0, counted.text);
  CHECK_MESSAGE(contains(counted.text, "left out: bob.tsv (bob.tsv), 0 of 1 catch trial passed"), counted.text);
  CHECK_MESSAGE(contains(counted.text, "1 of 2 raters kept, 1.0 answers for each trial"), counted.text);
  CHECK_MESSAGE(contains(counted.text, "| ours | theirs | 2 | 2 / 0 / 0 | 2 / 0 / 0 | 100.0 (34.2 to 100.0) |"),
                counted.text);
  const Outcome all = w.run({"study-count", "study.tsv", "ann.tsv", "bob.tsv", "--pass", "0", "--svg", "bars.svg"});
  CHECK(contains(ml::read_file(w / "bars.svg"), "ours : theirs"));
  CHECK_MESSAGE(contains(all.text, "| ours | theirs | 2 | 2 / 0 / 2 | 0 / 2 / 0 | 50.0 "), all.text);

  const Outcome hidden = w.run({"study", "study.tsv", "-o", "hidden.html", "--seed", "5", "--hide-text"});
  CHECK_MESSAGE(hidden.code == 0, hidden.text);
  CHECK(!contains(ml::read_file(w / "hidden.html"), "raise both arms"));
  for (const char* kind : {"ranking", "rating"}) {
    const Outcome other = w.run({"study", "study.tsv", "-o", "other.html", "--kind", kind});
    CHECK_MESSAGE(other.code == 0, other.text);
    const Outcome wrong = w.run({"study-count", "study.tsv", "ann.tsv", "--kind", kind});
    CHECK_MESSAGE((wrong.code == 1 && contains(wrong.text, "answers to another study")), wrong.text);
  }
  const Outcome over = w.run({"study", "study.tsv", "-o", "a.bvh"});
  CHECK_MESSAGE((over.code == 2 && contains(over.text, "is an input")), over.text);
}
