// Questions about body parts, in the three forms of SINC's table B.1.
#include <doctest/doctest.h>

#include <motionlang/compose/body_part_answers.hpp>
#include <motionlang/compose/body_part_prompts.hpp>

namespace ml = motionlang;
using Form = ml::BodyPartPrompt;

TEST_CASE("the forms differ by the list and the examples; each ends with the action") {
  CHECK(ml::body_part_prompt("wave", Form::free_form) == "List the body parts involved in this action: wave");
  const std::string list = ml::body_part_prompt("wave", Form::list), shots = ml::body_part_prompt("wave");
  const std::string end = "What are the body parts involved in the action: wave?\nAnswer:";
  for (const std::string& prompt : {list, shots}) {
    CHECK(prompt.find("choose answers from the list ['left arm', 'right arm'") != prompt.npos);
    CHECK(prompt.ends_with(end));
  }
  CHECK(list.find("sit down") == list.npos);
  // the answers of the examples are answers that we read
  CHECK(shots.find("sit down?\nAnswer: right leg\nleft leg\nbuttocks\nwaist") != shots.npos);
  CHECK(ml::parse_body_part_answer("Answer: right leg\nleft leg\nbuttocks\nwaist").count() == 3);
}

TEST_CASE("answers that name no part are nothing, where others throw") {
  CHECK(ml::known_body_part_answer("right arm\nhand") == ml::parse_body_part_answer("right arm"));
  CHECK(!ml::known_body_part_answer("the deltoids").has_value());
  CHECK(!ml::known_body_part_answer("").has_value());
  CHECK(ml::known_body_part_answer("shoulders")->count() == 2);
}
