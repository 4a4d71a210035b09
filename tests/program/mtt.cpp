// motionlang mtt, and generate --mode: timelines from a list of texts, and the baselines that STMC is compared with.
#include <doctest/doctest.h>

#include <set>

#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/mtt_timelines.hpp>
#include <motionlang/compose/timeline_text.hpp>

#include "small_workplace.hpp"

namespace {

const char* const texts_with_parts =
    "walk forward # legs\n"
    "sit down # legs # spine\n"
    "raise both arms # left arm # right arm\n"
    "wave the right hand # right arm\n";

struct MttWorkplace : Workplace {
  MttWorkplace() { ml::write_file(*this / "texts.txt", std::string_view(texts_with_parts)); }
};

}  // namespace

TEST_CASE("mtt: timelines of a list of texts, and those of the baselines") {
  const MttWorkplace w;
  const Outcome made = w.run({"mtt", "--texts", "texts.txt", "--out", "drawn", "--count", "30", "--seed", "7"});
  REQUIRE_MESSAGE(made.code == 0, made.text);
  CHECK_MESSAGE(contains(made.text, "30 timelines of 4 texts, "), made.text);
  auto files = w.files("drawn");
  REQUIRE(files.size() == 3);
  const auto timelines = ml::mtt_timelines(ml::parse_mtt_texts(texts_with_parts), {.count = 30, .seed = 7});
  CHECK(files.at("MTT.txt") == ml::write_timelines(timelines));
  const auto read = ml::parse_timelines_in_seconds(files.at("MTT.txt"));
  CHECK(read.size() == 30);
  std::vector<ml::TimelineInSeconds> single, one;
  for (const auto& t : read) single.push_back(ml::single_track(t)), one.push_back(ml::one_text(t));
  CHECK(files.at("MTT_singletrack.txt") == ml::write_timelines(single));
  CHECK(files.at("MTT_onetext.txt") == ml::write_timelines(one));

  const Outcome wrong = w.run({"mtt", "--texts", "two.txt"});  // a time is not a body part
  CHECK_MESSAGE((wrong.code == 3 && contains(wrong.text, "[motionlang.timeline.503] two.txt:1:")), wrong.text);
  ml::write_file(w / "legs.txt", std::string_view("walk # legs\nrun # legs\n"));
  const Outcome none = w.run({"mtt", "--texts", "legs.txt", "--out", "none"});
  CHECK_MESSAGE((none.code == 1 && contains(none.text, "[motionlang.config.102]")), none.text);
  CHECK(!std::filesystem::exists(w / "none"));
}

TEST_CASE("generate --mode: the baselines, without those of the texts that are cut") {
  const Workplace w;
  std::set<std::string> motions;
  for (const ml::StmcMode mode : ml::stmc_modes) {
    const std::string name(ml::to_string(mode));
    const Outcome made = w.generate(name, {"--mode", name});
    REQUIRE_MESSAGE(made.code == 0, made.text);
    motions.insert(w.files(name).at("two.npy"));
  }
  CHECK(motions.size() == 5);
  // The same as a timeline that is written so, where the program cuts no texts.
  const auto same = [&](const std::string& mode, const ml::TimelineInSeconds& timeline) {
    ml::write_file(w / "two.txt", ml::write_timeline(timeline));
    const Outcome made = w.generate("as_" + mode, {"--no-cut-texts"});
    REQUIRE_MESSAGE(made.code == 0, made.text);
    CHECK(w.files("as_" + mode).at("two.npy") == w.files(mode).at("two.npy"));
  };
  const auto timeline = ml::parse_timelines_in_seconds(timeline_text).front();
  same("single-track", ml::single_track(timeline));
  same("one-text", ml::one_text(timeline));

  const auto refused = [&](std::vector<std::string> options, const std::string& why) {
    const Outcome made = w.generate("no", std::move(options));
    CHECK_MESSAGE((made.code == 2 && contains(made.text, why)), made.text);
  };
  refused({"--mode", "sinc", "--record"}, "--mode sinc excludes --keep, --record, --reuse and --overlay-arms");
  refused({"--mode", "teach"}, "--mode");
}

TEST_CASE("generate --noise-factor: the square root of Sigma, or Sigma as in the published program") {
  const Workplace w;
  const auto motion = [&](const std::string& out, std::vector<std::string> options) {
    const Outcome made = w.generate(out, std::move(options));
    REQUIRE_MESSAGE(made.code == 0, made.text);
    return w.files(out).at("two.npy");
  };
  const std::string usual = motion("usual", {});
  CHECK(motion("paper", {"--noise-factor", "paper"}) == usual);
  CHECK(motion("published", {"--noise-factor", "published"}) != usual);
}
