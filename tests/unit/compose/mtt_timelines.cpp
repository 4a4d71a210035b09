// Timelines drawn from a list of texts.
#include <motionlang/compose/mtt_timelines.hpp>

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
