// motionlang mtt, and evaluate of STMC: timelines from a list of texts, and the tables of motions made of them.
#include <doctest/doctest.h>

#include <set>
#include <sstream>

#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/mtt_timelines.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/bvh.hpp>

#include "../support/synthetic_motion.hpp"
#include "small_workplace.hpp"

namespace {

const char* const texts_with_parts =
    "walk forward # legs\n"
    "sit down # legs # spine\n"
    "raise both arms # left arm # right arm\n"
    "wave the right hand # right arm\n";

/// The numbers of the first row that begins so, "-" is -1.
std::vector<double> numbers_of_row(const std::string& text, const std::string& name, std::size_t from = 0) {
  const auto at = text.find("  " + name + " ", from);
  REQUIRE_MESSAGE(at != std::string::npos, text);
  std::istringstream rest(text.substr(at + name.size() + 2, text.find('\n', at) - at - name.size() - 2));
  std::vector<double> out;
  for (std::string word; rest >> word;) {
    if (word == "multi" || word == "single") continue;
    out.push_back(word == "-" ? -1 : std::stod(word));
  }
  return out;
}

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

TEST_CASE("evaluate: STMC and its baselines on timelines, judged by the bundled TMR") {
  const MttWorkplace w;
  const std::vector<std::string> how{"evaluate", "model.safetensors", "--texts", "texts.txt", "--first",
                                     "5",        "--steps",           "2",       "--batch",   "2"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), how.begin(), how.end());
    return w.run(more);
  };
  const Outcome plain = with({"--overlaps", "0.25,1"});
  REQUIRE_MESSAGE(plain.code == 0, plain.text);
  CHECK_MESSAGE(contains(plain.text, "5 timelines of 4 texts, seed 0; judged by "), plain.text);
  const auto written = plain.text.find("as written in the thesis");
  REQUIRE_MESSAGE((written != std::string::npos && contains(plain.text, "as coded, to compare")), plain.text);
  for (const std::string name : {"one text", "DiffCollage, single track", "SINC without lerp", "SINC with lerp", "STMC",
                                 "STMC, overlap 0.25 s", "STMC, overlap 1 s"}) {
    for (const std::size_t from : {std::size_t{0}, written}) {
      const auto n = numbers_of_row(plain.text, name, from);
      REQUIRE_MESSAGE(n.size() == 6, plain.text);
      CHECK((n[0] >= 0 && n[0] <= n[1] && n[1] <= 100));
      CHECK((n[2] > 0 && n[2] < 1 && n[3] == -1 && n[4] == -1 && n[5] > 0));
    }
    CHECK(numbers_of_row(plain.text, name)[5] != numbers_of_row(plain.text, name, written)[5]);  // another distance
  }

  // Recorded motions: a walk for each text, as BVH and as joints; one of them in a mirror.
  for (int i = 0; i < 4; ++i)
    ml::write_bvh(w / ("clip" + std::to_string(i) + ".bvh"),
                  synthetic::walk({.frames = 60 + 10 * i, .steps_per_second = 0.8 + 0.3 * i, .turn = 0.4 * i}));
  ml::write_file(w / "motions.txt",
                 std::string_view("clip0 # 0 # 2.5\nclip1.bvh # 0.5 # 3\nM/clip2 # 0 # 3\nclip3 # 1 # 4\n"));
  const Outcome recorded = with({"--recorded", "motions.txt", "--data", ".", "--modes", "sinc,stmc", "--seed", "3"});
  REQUIRE_MESSAGE(recorded.code == 0, recorded.text);
  CHECK_MESSAGE(!contains(recorded.text, "one text"), recorded.text);
  const auto truth = numbers_of_row(recorded.text, "recorded");  // tracks and crops are "-"
  REQUIRE(truth.size() == 8);
  CHECK((truth[5] == 1 && truth[6] == 0 && truth[7] > 0));
  const auto stmc = numbers_of_row(recorded.text, "STMC");
  CHECK((stmc[3] > 0 && stmc[3] < 1 && stmc[4] > 0));

  // A file of timelines gives the same figures as drawing them.
  REQUIRE(w.run({"mtt", "--texts", "texts.txt", "--out", ".", "--count", "8"}).code == 0);
  const Outcome named = with({"--timelines", "MTT.txt", "--modes", "stmc", "--table", "latex"});
  REQUIRE_MESSAGE(named.code == 0, named.text);
  CHECK_MESSAGE(contains(named.text, "\nSTMC                             & "), named.text);
  const Outcome drawn = with({"--modes", "stmc", "--table", "latex"});
  const auto tables = [](const std::string& text) {
    return text.substr(text.find("as coded"), text.rfind("\\\\") - text.find("as coded"));
  };
  CHECK(tables(named.text) == tables(drawn.text));
}

TEST_CASE("evaluate: what STMC cannot be measured with is refused") {
  const MttWorkplace w;
  const auto refused = [&](std::vector<std::string> options, int code, const std::string& why) {
    options.insert(options.begin(), {"evaluate", "model.safetensors"});
    const Outcome made = w.run(options);
    CHECK_MESSAGE((made.code == code && contains(made.text, why)), made.text);
  };
  refused({}, 2, "--texts is needed to measure STMC");
  refused({"--texts", "texts.txt", "--dataset", "uestc"}, 2, "--dataset is for ACTOR and the classifier, not stmc");
  refused({"--texts", "texts.txt", "--data", "."}, 2, "--recorded and --data belong together");
  ml::write_file(w / "motions.txt", std::string_view("clip # 0 # 2.5\n"));
  refused({"--texts", "texts.txt", "--data", ".", "--recorded", "motions.txt"}, 1, "motions.txt: 1 clip for 4 texts");
  ml::write_file(w / "other.txt", std::string_view("fly # 0 # 2 # legs\nwalk forward # 2 # 4 # legs\n"));
  refused({"--texts", "texts.txt", "--timelines", "other.txt"}, 1, "'fly' is not among the 4 texts");
}
