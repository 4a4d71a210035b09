// Long texts in parts.
#include <doctest/doctest.h>

#include <motionlang/compose/long_texts.hpp>
#include <motionlang/compose/timeline_text.hpp>

namespace ml = motionlang;

namespace {

ml::Timeline parsed(const char* text) { return ml::parse_timeline(text, {.fps = 1}); }

}  // namespace

TEST_CASE("a text that is too long becomes parts of equal length; others stay") {
  const auto timeline = parsed(
      "walk # 5 # 30 # legs\n"
      "raise both arms # 10 # 20 # left arm # right arm\n"
      "nod # 10 # 21 # head\n");
  CHECK(ml::divide_long_texts(timeline, 10) == parsed("walk # 5 # 13 # legs\n"
                                                      "walk # 13 # 21 # legs\n"
                                                      "walk # 21 # 30 # legs\n"
                                                      "raise both arms # 10 # 20 # left arm # right arm\n"
                                                      "nod # 10 # 15 # head\n"
                                                      "nod # 15 # 21 # head\n"));
  CHECK(ml::divide_long_texts(timeline, 25) == timeline);
  CHECK(ml::divide_long_texts(timeline, 1).intervals.size() == 25 + 10 + 11);
  CHECK_THROWS_WITH_AS(ml::divide_long_texts(timeline, 0),
                       doctest::Contains("[motionlang.config.101] divide_long_texts: parts of 0"), ml::config_error);
  CHECK_THROWS_WITH_AS(ml::divide_long_texts(parsed("walk # 0 # 1000001\n"), 10),
                       doctest::Contains("'walk' of 1000001 frames makes 100001 parts, expected 100000 at most"),
                       ml::config_error);
}
