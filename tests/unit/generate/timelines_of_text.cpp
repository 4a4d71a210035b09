#include <motionlang/generate/timelines_of_text.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

TEST_CASE("timelines, or a list of texts of which each is a timeline") {
  const auto two = ml::timelines_of_text("walk # 0 # 1 # legs\nwave # 0 # 1 # left arm\n\nrun # 0 # 2\n", {.fps = 10});
  REQUIRE((two.size() == 2 && two[0].intervals.size() == 2));
  CHECK(two[1].end() == 20);
  const auto list = ml::timelines_of_text("walk # 1\nrun # 2.5\n", {.fps = 10});
  REQUIRE(list.size() == 2);
  CHECK(list[1] == ml::Timeline{{{"run", 0, 25, ml::BodyParts::all()}}});
  CHECK_ERROR(ml::timelines_of_text("walk # x\n", {.name = "moves.txt"}), "[motionlang.timeline.502] moves.txt:1:8");
  CHECK_ERROR(ml::timelines_of_text("walk # 0 # x # legs\nrun # 1 # 2\n"), "[motionlang.timeline.502] timeline:1:12");
}
