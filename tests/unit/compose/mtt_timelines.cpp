// Timelines drawn from a list of texts.
#include <motionlang/compose/mtt_timelines.hpp>

#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/timeline_text.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using enum ml::BodyPart;

namespace {

const std::vector<ml::MttText> texts = ml::parse_mtt_texts(
    "walk # legs\n\nwave # right arm\r\nthrow # left arm # right arm\nnod # head\nbow # spine\nhop#legs#spine\n");

}  // namespace

TEST_CASE("parse_mtt_texts: a text and its parts on each line") {
  REQUIRE(texts.size() == 6);
  CHECK(texts[2].text == "throw");
  CHECK(texts[2].parts == ml::BodyParts{}.with(left_arm).with(right_arm));
  CHECK_ERROR(ml::parse_mtt_texts("walk\n", "list"), "[motionlang.timeline.501] list:1:5");
  CHECK_ERROR(ml::parse_mtt_texts("walk # wing\n"), "[motionlang.timeline.503]");
  CHECK_ERROR(ml::parse_mtt_texts("\n"), "[motionlang.timeline.507]");
  CHECK_ERROR(ml::parse_mtt_texts("w\xE4lk # legs\n"), "[motionlang.timeline.501]");
}

TEST_CASE("mtt_timelines: two tracks, other parts beside each other, hundredths of seconds") {
  const auto timelines = ml::mtt_timelines(texts, {.count = 200});
  REQUIRE(timelines.size() == 200);
  double sum = 0;
  for (const auto& t : timelines) {
    REQUIRE(t.intervals.size() == 3);
    const auto &one = t.intervals[0], &two = t.intervals[1], &third = t.intervals[2];
    CHECK(one.start == 0);
    CHECK(one.end == two.start);
    CHECK(third.end <= two.end + 1e-9);
    for (const auto* other : {&one, &two}) {
      CHECK(third.text != other->text);
      // A hundredth may be cut off when times are written.
      const bool meet = third.start < other->end - 0.011 && other->start < third.end - 0.011;
      if (meet) CHECK((third.parts.bits & other->parts.bits) == 0);
      CHECK(other->end - other->start < 9.21);
    }
    sum += one.end;
  }
  CHECK(sum / 200 == doctest::Approx(6).epsilon(0.1));
  CHECK(ml::mtt_timelines(texts, {.count = 3}) == std::vector(timelines.begin(), timelines.begin() + 3));
  CHECK(ml::mtt_timelines(texts, {.count = 3, .seed = 1}) != ml::mtt_timelines(texts, {.count = 3}));
}

TEST_CASE("mtt_timelines: lists that give none") {
  CHECK_ERROR(ml::mtt_timelines({}, {}), "[motionlang.config.101]");
  const auto legs = ml::parse_mtt_texts("walk # legs\nrun # legs\nhop # legs\n");
  CHECK_ERROR(ml::mtt_timelines(legs, {}), "[motionlang.config.102]");
  CHECK(ml::mtt_timelines(legs, {.count = 0}).empty());
}

TEST_CASE("mtt_files: the timelines, and those of the baselines as they are made from the written file") {
  const auto timelines = ml::mtt_timelines(texts, {.count = 40});
  const ml::MttFiles files = ml::mtt_files(timelines);
  CHECK(files.multi_track == ml::write_timelines(timelines));
  const auto read = ml::parse_timelines_in_seconds(files.multi_track, {.as_published = true});
  REQUIRE(read.size() == 40);
  std::vector<ml::TimelineInSeconds> single, one;
  for (const auto& t : read) single.push_back(ml::single_track(t)), one.push_back(ml::one_text(t));
  CHECK(files.single_track == ml::write_timelines(single));
  CHECK(files.one_text == ml::write_timelines(one));
  CHECK(files.one_text.find(" and then ") != std::string::npos);
  const auto by_hand = ml::mtt_files(std::vector<ml::TimelineInSeconds>{
      {{{"walk", 0, 6, texts[0].parts}, {"hop", 6, 11, texts[5].parts}, {"wave", 4.5, 7.25, texts[1].parts}}}});
  CHECK(by_hand.single_track ==
        "walk # 0.0 # 4.5 # legs\nwalk while wave # 4.5 # 6.0 # legs # right arm\n"
        "hop while wave # 6.0 # 7.25 # legs # right arm # spine\nhop # 7.25 # 11.0 # legs # spine\n\n");
  CHECK(by_hand.one_text == "walk and then hop while wave # 0.0 # 9.8 # legs # right arm # spine\n\n");
}

TEST_CASE("mtt_labels: the number of the text of each interval") {
  const auto timeline = ml::mtt_timelines(texts, {.count = 1}).front();
  const auto labels = ml::mtt_labels(texts, timeline);
  REQUIRE(labels.size() == 3);
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(texts[static_cast<std::size_t>(labels[i])].text == timeline.intervals[i].text);
  CHECK_ERROR(ml::mtt_labels(texts, {{{"fly", 0, 1, {}}}}), "[motionlang.config.102] mtt_labels: 'fly' is not among");
}
