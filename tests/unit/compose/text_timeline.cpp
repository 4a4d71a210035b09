// The times of a text, and what follows its action.
#include <motionlang/compose/text_timeline.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"
#include "../../support/word_count_encoder.hpp"

namespace ml = motionlang;

namespace {

const ml::BodyParts all = ml::BodyParts::all();

}  // namespace

TEST_CASE("a text lasts as long as its action, if nothing else is wanted") {
  const auto captions = counted::captions();
  CHECK(ml::text_timeline("sit", captions) == ml::Timeline{{{"sit", 0, 40, all}}});
  CHECK(ml::usual_seconds("walk", captions) == 4);        // repeats, so that one round is too short
  CHECK(ml::usual_seconds("sit down", captions) == 2.8);  // by its words
  CHECK(ml::usual_seconds("bend forward", captions) == 2.7);
  CHECK(ml::usual_seconds("blorp", captions) == ml::text_seconds);
  CHECK(ml::usual_seconds("sit", {}) == ml::text_seconds);
  CHECK(ml::text_timeline("sit", {}, {.fps = 10}) == ml::Timeline{{{"sit", 0, 50, all}}});
}

TEST_CASE("what ends is made once, what repeats goes on") {
  const auto captions = counted::captions();
  CHECK(ml::text_timeline("sit", captions, {.seconds = 15}) ==
        ml::Timeline{{{"sit", 0, 40, all}, {"sit quietly", 40, 300, all}}});
  CHECK(ml::text_timeline("walk", captions, {.seconds = 15}) == ml::Timeline{{{"walk", 0, 300, all}}});
  CHECK(ml::text_timeline("sit", captions, {.seconds = 2.9}) == ml::Timeline{{{"sit", 0, 58, all}}});
  CHECK(ml::text_timeline("sit", captions, {.seconds = 15, .end_actions = false}) ==
        ml::Timeline{{{"sit", 0, 300, all}}});
  CHECK(ml::text_timeline("walk, then sit down", {}, {.seconds = 7}) ==
        ml::Timeline{{{"walk, then sit down", 0, 140, all}}});  // without captions nobody knows when it ends
  // cut_texts knows this one, and what comes before it
  CHECK(ml::text_timeline("kick", captions, {.seconds = 15}) == ml::Timeline{{{"kick", 0, 300, all}}});
}

TEST_CASE("actions in turn share the time, or take their own") {
  const auto captions = counted::captions();
  CHECK(ml::text_timeline("sit, then walk", captions, {.in_turn = true}) ==
        ml::Timeline{{{"sit", 0, 40, all}, {"walk", 40, 120, all}}});
  CHECK(ml::text_timeline("sit, then walk", captions, {.seconds = 8, .in_turn = true}) ==
        ml::Timeline{{{"sit", 0, 40, all}, {"sit quietly", 40, 80, all}, {"walk", 80, 160, all}}});
  const ml::TextTimelineOptions whole{.seconds = 6, .end_actions = false};
  CHECK(ml::text_timeline("sit, then walk", captions, whole).intervals.size() == 1);
  // Without being asked, if captions know each action, and none says both.
  CHECK(ml::text_timeline("sit, then walk", captions) == ml::Timeline{{{"sit", 0, 40, all}, {"walk", 40, 120, all}}});
  CHECK(ml::text_timeline("walk, sit and walk", captions).intervals.size() == 3);
  CHECK(ml::text_timeline("walk, then sit", captions, {.seconds = 7.9}) ==
        ml::Timeline{{{"walk", 0, 79, all}, {"sit", 79, 119, all}, {"sit quietly", 119, 158, all}}});
  CHECK(ml::known_in_turn("walk, then blorp", captions).size() == 1);
  CHECK(ml::known_in_turn("walk, slowly", captions).size() == 1);
  CHECK(ml::known_in_turn("walk", captions).size() == 1);
  CHECK(ml::text_timeline("walk, then sit", captions, {.seconds = 10}).intervals.size() == 3);  // one would start again
  CHECK(ml::text_timeline("walk, then sit", captions, {.seconds = 10, .end_actions = false}).intervals.size() == 1);
  CHECK(ml::usual_seconds("walk, then blorp", captions) == ml::text_seconds);
  CHECK_ERROR(ml::text_timeline("sit, then walk", captions, {.seconds = 0.05, .in_turn = true}),
              "'sit, then walk' has 2 actions in 1 frame");
}

TEST_CASE("intervals that are much longer than their action") {
  const auto captions = counted::captions();
  const auto outlasts = [&](const char* text, ml::Index frames) {
    return ml::outlasts_action({text, 0, frames, all}, captions, 20);
  };
  CHECK(outlasts("sit", 81));
  CHECK_FALSE(outlasts("sit", 80));
  CHECK_FALSE(outlasts("walk", 900));
  CHECK_FALSE(outlasts("blorp", 900));
}
