// Body parts of SINC: what a language model answered, tables of answers, what can be combined.
#include <doctest/doctest.h>

#include <sstream>  // prints sets of parts

#include <motionlang/compose/body_part_answers.hpp>
#include <motionlang/datasets/body_part_table.hpp>
#include <motionlang/file/json_members.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using enum ml::SincPart;

TEST_CASE("answers about body parts") {
  const auto parse = [](std::string_view answer) { return ml::parse_body_part_answer(answer); };
  CHECK(parse("Answer: right arm") == ml::sinc_parts(right_arm));
  CHECK(parse("right leg\nleft leg\nbuttocks\nwaist") == ml::sinc_parts(global, left_leg, right_leg));
  CHECK(parse("Answer: Shoulders.") == ml::sinc_parts(left_arm, right_arm));
  CHECK(parse("shoulders\nLEFT ARM") == ml::sinc_parts(left_arm));
  CHECK(parse("-Torso;\n- Waist!\n\n") == ml::sinc_parts(global, torso));
  CHECK(parse("wrist\nright arm\nhand\nright eye\nneck") == ml::sinc_parts(right_arm, torso));
  CHECK(parse("right shoulder\nleft shoulder") == ml::sinc_parts(left_arm, right_arm));
  CHECK_ERROR(parse("tail\nright arm"), "[motionlang.config.103] parse_body_part_answer: 'tail'");
  CHECK_ERROR(parse("hand"), "[motionlang.config.103] parse_body_part_answer: no body part in 'hand'");
  CHECK_ERROR(parse(""), "[motionlang.config.103]");
}

TEST_CASE("tables of answers keep the order of the file") {
  const auto file = ml::JsonMembers::from_text(
      R"({"wave": ["", "", "right arm"], "walk": ["", "neck", "left leg\nright leg"], "swim on air": ["", "", "?"]})",
      "t.json");
  const ml::BodyPartTable table = ml::read_body_part_table(file);
  CHECK(table.labels() == std::vector<std::string>{"wave", "walk", "swim on air"});
  CHECK(table.parts("walk") == ml::sinc_parts(left_leg, right_leg));
  CHECK(table.parts("swim on air").all());
  CHECK(ml::are_compatible(table.parts("wave"), table.parts("walk")));
  CHECK_FALSE(ml::are_compatible(table.parts("wave"), table.parts("swim on air")));
  CHECK_ERROR(table.parts("fly"), "[motionlang.config.103] BodyPartTable: no parts of 'fly'");
  CHECK_ERROR(ml::read_body_part_table(file, 1), "[motionlang.config.103] parse_body_part_answer");
  CHECK_ERROR(ml::read_body_part_table(file, 3), "[motionlang.config.107] t.json: wave: ");
}
