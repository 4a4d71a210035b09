// Parts of SINC that somebody wrote down, that a table knows, or that are guessed.
#include <doctest/doctest.h>

#include <motionlang/compose/body_part_lexicon.hpp>
#include <motionlang/compose/text_sinc_parts.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using enum ml::SincPart;

TEST_CASE("lists of parts are read, other texts are looked up or guessed") {
  CHECK(ml::parse_sinc_parts("left arm, right arm") == ml::sinc_parts(left_arm, right_arm));
  CHECK(ml::parse_sinc_parts("global,torso,") == ml::sinc_parts(global, torso));
  CHECK(!ml::parse_sinc_parts("a person waves"));
  CHECK(!ml::parse_sinc_parts("left arm, tail"));

  CHECK(ml::text_sinc_parts("", nullptr).all());
  CHECK(ml::text_sinc_parts("torso", nullptr) == ml::sinc_parts(torso));
  CHECK(ml::text_sinc_parts("a person walks", nullptr) == ml::as_sinc_parts(ml::guess_body_parts("a person walks")));
  CHECK(ml::text_sinc_parts("a person walks", nullptr).test(static_cast<std::size_t>(left_leg)));
  ml::BodyPartTable table;
  table.add("a person walks", "right arm");
  CHECK(ml::text_sinc_parts("a person walks", &table) == ml::sinc_parts(right_arm));
  CHECK(ml::text_sinc_parts("left leg", &table) == ml::sinc_parts(left_leg));
  CHECK_ERROR(ml::text_sinc_parts("a person sits", &table), "[motionlang.config.103]");

  CHECK(ml::as_sinc_parts(ml::BodyParts::all()).all());
  CHECK(ml::as_sinc_parts(ml::BodyParts{}.with(ml::BodyPart::head)) == ml::sinc_parts(torso));
  CHECK(ml::as_sinc_parts(ml::BodyParts{}.with(ml::BodyPart::legs)) == ml::sinc_parts(global, left_leg, right_leg));
  CHECK(ml::list_sinc_parts(ml::sinc_parts(right_leg, global)) == "global, right leg");
  CHECK(ml::list_sinc_parts({}) == "");
}
