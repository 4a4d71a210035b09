// Captions of mirrored motions.
#include <doctest/doctest.h>

#include <motionlang/text/mirror_caption.hpp>

using motionlang::mirror_caption;

TEST_CASE("mirror_caption: sides are exchanged, all at once") {
  CHECK(mirror_caption("from left to right") == "from right to left");
  CHECK(mirror_caption("Left arm, RIGHT leg; left-handed") == "Right arm, LEFT leg; right-handed");
  CHECK(mirror_caption("a step leftwards, a rightward turn, the leftmost chair, two lefts") ==
        "a step rightwards, a leftward turn, the rightmost chair, two rights");
  CHECK(mirror_caption("") == "");
  CHECK(mirror_caption("  walks .. forward ") == "  walks .. forward ");
}

TEST_CASE("mirror_caption: directions of turning, in one word or in parts") {
  CHECK(mirror_caption("clockwise then counterclockwise, anticlockwise") ==
        "counterclockwise then clockwise, clockwise");
  CHECK(mirror_caption("Counter-Clockwise") == "Clockwise");
  CHECK(mirror_caption("counter clock-wise, clock-wise, anti clockwise") == "clockwise, counterclockwise, clockwise");
  CHECK(mirror_caption("the counter. clockwise") == "the counter. counterclockwise");
  CHECK(mirror_caption("left clockwise right") == "right counterclockwise left");
}

TEST_CASE("mirror_caption: whole words only") {
  for (const char* same : {"stands upright", "bright cleft", "leftover", "rightly", "lefté", "right2", "otherwise"}) {
    CHECK(mirror_caption(same) == same);
  }
}

TEST_CASE("mirror_caption: twice is the same caption") {
  for (const char* text : {"turns left 90 degrees", "Clockwise to the RIGHT", "a counterclockwise circle, leftward"}) {
    CHECK(mirror_caption(mirror_caption(text)) == text);
  }
}
