// Actions that end.
#include <motionlang/compose/natural_lengths.hpp>

#include <doctest/doctest.h>

#include <motionlang/compose/cut_texts.hpp>

namespace ml = motionlang;

TEST_CASE("how long actions take, and what follows") {
  for (const char* text : {"turn left", "a person turns around", "Raise both arms.", "sit down", "jump forward",
                           "bend forward", "stand up", "kick with the right leg", "someone bows"})
    CHECK_MESSAGE(ml::natural_length(text), text);
  for (const char* text : {"walk forward", "run", "stand still", "dance", "jump up and down", "do jumping jacks",
                           "turn left and walk", "raise both arms again", "jump three times", "turn in circles",
                           "jumping", "", "walk and turn left", "swing the arms"})
    CHECK_MESSAGE(!ml::natural_length(text), text);
  CHECK(ml::natural_length("sit down")->then == "sit quietly");
  CHECK(ml::natural_length("raise the left arm")->then == "hold the left arm up");
  CHECK(ml::natural_length("raise your hand")->then == "hold the right arm up");
  CHECK(ml::natural_length("lift both hands")->then == "hold both arms up");
}

TEST_CASE("texts that last longer than their action become two") {
  const auto parts = ml::BodyParts{}.with(ml::BodyPart::legs);
  const ml::Timeline timeline{{{"sit down", 20, 200, parts},
                               {"walk forward", 0, 200, ml::BodyParts::all()},
                               {"turn left", 0, 60, ml::BodyParts::all()}}};
  const auto ended = ml::end_actions(timeline, 20);
  REQUIRE(ended.intervals.size() == 4);
  CHECK(ended.intervals[0] == ml::Interval{"sit down", 20, 76, parts});
  CHECK(ended.intervals[1] == ml::Interval{"sit quietly", 76, 200, parts});
  CHECK(ended.intervals[2] == timeline.intervals[1]);
  CHECK(ended.intervals[3] == timeline.intervals[2]);  // less than a second too long
  CHECK(ml::cut_texts({{{"sit down", 0, 100, ml::BodyParts::all()}}}, 20).intervals.size() == 2);
  const auto raised = ml::end_actions({{{"raise both arms", 0, 100, ml::BodyParts::all()}}}, 20);
  REQUIRE(raised.intervals.size() == 3);
  CHECK(raised.intervals[0] == ml::Interval{"stand still", 0, 10, ml::BodyParts::all()});
  CHECK(raised.intervals[1] == ml::Interval{"raise both arms", 10, 54, ml::BodyParts::all()});
  CHECK(raised.intervals[2] == ml::Interval{"hold both arms up", 54, 100, ml::BodyParts::all()});
  CHECK(ml::end_actions({{{"bend forward", 0, 30, ml::BodyParts::all()}}}, 20).intervals.size() == 1);  // too short
  ml::Timeline other = timeline;
  other.body = ml::BodyPartition({.names = {"legs", "trunk"}, .path = "legs"});
  CHECK(ml::end_actions(other, 20).intervals == other.intervals);
}
