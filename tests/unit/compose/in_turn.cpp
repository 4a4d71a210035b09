// Sentences of several actions.
#include <doctest/doctest.h>

#include <motionlang/compose/in_turn.hpp>
#include <motionlang/compose/timeline_text.hpp>

namespace ml = motionlang;

TEST_CASE("a sentence is cut where it says that something follows") {
  using Actions = std::vector<std::string>;
  CHECK(ml::actions_in_turn("walk forward then sit down") == Actions{"walk forward", "sit down"});
  CHECK(ml::actions_in_turn("walk forward, then sit down and wave") == Actions{"walk forward", "sit down and wave"});
  CHECK(ml::actions_in_turn("Walk, and then turn left. Then, jump!") == Actions{"Walk", "turn left", "jump!"});
  CHECK(ml::actions_in_turn("walk; turn left ; jump.") == Actions{"walk", "turn left", "jump"});
  CHECK(ml::actions_in_turn("walk , afterwards a jump followed by a kick") == Actions{"walk", "a jump", "a kick"});
  CHECK(ml::actions_in_turn("  then walk after that  sit") == Actions{"walk", "sit"});
}

TEST_CASE("a sentence of one action stays as it is") {
  for (const char* text : {"", "walk", " walk forward, slowly. ", "walk and wave", "follow after somebody", "and",
                           "then", "a thenar", "walk then", "; walk"}) {
    CAPTURE(text);
    CHECK(ml::actions_in_turn(text) == std::vector<std::string>{text});
  }
}

TEST_CASE("commas cut a list, and so does its last and") {
  using Actions = std::vector<std::string>;
  CHECK(ml::listed_in_turn("walk, turn left and wave") == Actions{"walk", "turn left", "wave"});
  CHECK(ml::listed_in_turn("walk, turn left, and wave.") == Actions{"walk", "turn left", "wave."});
  CHECK(ml::listed_in_turn("walk,turn, then sit and wave") == Actions{"walk,turn", "sit and wave"});
  CHECK(ml::listed_in_turn("walk and wave") == Actions{"walk and wave"});
  CHECK(ml::listed_in_turn(" , ") == Actions{" , "});
}

TEST_CASE("actions share the frames of their text") {
  const auto parsed = [](const char* text) { return ml::parse_timeline(text, {.fps = 1}); };
  CHECK(ml::in_turn(parsed("walk, then turn, then sit # 0 # 10 # legs\n"
                           "nod # 1 # 4 # head\n")) == parsed("walk # 0 # 3 # legs\n"
                                                              "turn # 3 # 6 # legs\n"
                                                              "sit # 6 # 10 # legs\n"
                                                              "nod # 1 # 4 # head\n"));
  CHECK_THROWS_WITH_AS(ml::in_turn(parsed("walk; run; sit # 0 # 2\n")),
                       doctest::Contains("[motionlang.config.101] in_turn: 'walk; run; sit' has 3 actions in 2 frames"),
                       ml::config_error);
}
