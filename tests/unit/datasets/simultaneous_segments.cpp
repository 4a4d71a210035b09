// SINC: stretches in which several actions happen at once.
#include <doctest/doctest.h>

#include <motionlang/datasets/simultaneous_segments.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using Segments = std::vector<ml::BabelSegment>;
using Found = std::vector<ml::SimultaneousSegment>;

TEST_CASE("simultaneous segments: the examples of the specification") {
  CHECK(ml::simultaneous_segments(Segments{
            {39, 150, "walk"}, {60, 120, "wave"}, {135, 195, "turn"}, {210, 270, "sit"}, {270, 330, "rise"}}) ==
        Found{{60, 120, {"walk", "wave"}}, {135, 150, {"turn", "walk"}}});
  CHECK(ml::simultaneous_segments(
            Segments{{0, 60, "walk"}, {30, 90, "wave"}, {40, 50, "nod"}, {80, 120, "walk"}, {100, 140, "walk"}}) ==
        Found{{30, 40, {"walk", "wave"}},
              {40, 50, {"nod", "walk", "wave"}},
              {50, 60, {"walk", "wave"}},
              {80, 90, {"walk", "wave"}},
              {100, 120, {"walk", "walk"}}});
}

TEST_CASE("simultaneous segments: transitions, too many, none") {
  const Segments three{{0, 10, "a"}, {0, 10, "b"}, {0, 10, "transition"}};
  CHECK(ml::simultaneous_segments(three) == Found{{0, 10, {"a", "b", "transition"}}});
  CHECK(ml::simultaneous_segments(three, 2).empty());
  CHECK(ml::simultaneous_segments(Segments{{0, 10, "a"}, {5, 10, "transition"}}).empty());
  CHECK(ml::simultaneous_segments(Segments{{0, 10, "a"}, {10, 20, "b"}}).empty());
  CHECK(ml::simultaneous_segments(Segments{}).empty());
  CHECK_ERROR(ml::simultaneous_segments(Segments{{5, 5, "a"}}), "[motionlang.config.101] simultaneous_segments: 'a'");
}

TEST_CASE("SINC takes segments in their order, without empty and excluded ones") {
  CHECK(ml::sinc_segments({{5, 9, "b"}, {0, 4, "t-pose"}, {3, 3, "c"}, {1, 2, ""}, {0, 4, "transition"}}) ==
        Segments{{5, 9, "b"}, {1, 2, ""}});
}
