#include <motionlang/generate/kept_clip_text.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

TEST_CASE("time ranges of a kept clip") {
  CHECK(ml::parse_kept_range("0-1.5") == std::pair(0.0, 1.5));
  CHECK(ml::parse_kept_range(" 2.25-3 ") == std::pair(2.25, 3.0));
  for (const char* wrong : {"", "1", "1-", "-1", "3-1", "1-1", "0-1-2", "a-b", "0-inf"})
    CHECK_ERROR(ml::parse_kept_range(wrong), "' is not a time range like 0-1.5");
  CHECK_ERROR(ml::parse_kept_range("3-1"), "[motionlang.config.101] `keep_seconds`: '3-1' is not a time range");
}

TEST_CASE("body parts of a kept clip") {
  CHECK(ml::parse_kept_parts("legs") == ml::BodyParts{}.with(ml::BodyPart::legs));
  CHECK(ml::parse_kept_parts("left arm, head") ==
        ml::BodyParts{}.with(ml::BodyPart::left_arm).with(ml::BodyPart::head));
  CHECK(ml::parse_kept_parts("legs,legs").count() == 1);
  CHECK_ERROR(ml::parse_kept_parts("legs,tail"), "[motionlang.config.103] `keep_parts`: 'tail' is not one of left arm");
  CHECK_ERROR(ml::parse_kept_parts(""), "'' is not one of");
  CHECK_ERROR(ml::parse_kept_parts("legs,"), "'' is not one of");
}

TEST_CASE("a part of a motion is kept from a time on, as far as the motion goes") {
  const ml::Motion walk = synthetic::walk({.frames = 40, .fps = 20});
  const ml::Motion kept = ml::kept_part(walk, 0.5, 1, 1.5);
  CHECK(kept.frames() == 30 + 10);
  for (const ml::Index f : {0, 30}) CHECK(kept.root[static_cast<std::size_t>(f)] == walk.root[10]);
  CHECK(kept.root.back() == walk.root[19]);
  CHECK(ml::kept_part(walk, 1.5, 9, 0).frames() == 10);
}
