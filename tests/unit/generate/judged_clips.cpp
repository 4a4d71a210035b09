#include <motionlang/generate/judged_clips.hpp>

#include <doctest/doctest.h>

#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;

namespace {

ml::CaptionedSegment segment(const char* caption, double height = 0) {
  ml::CaptionedSegment s{
      .clip = "clip", .motion = synthetic::walk({.frames = 60}), .parts = {}, .captions = {caption}, .loop = {}};
  for (auto& p : s.motion.root) p.y += height;
  return s;
}

}  // namespace

TEST_CASE("recordings that do not stand on the floor are left out") {
  CHECK(ml::stands_on_floor(segment("walk forward")));
  CHECK_FALSE(ml::stands_on_floor(segment("walk forward", 0.3)));
  CHECK_FALSE(ml::stands_on_floor(segment("walk up the stairs")));
  const auto figures =
      ml::judge_recordings({segment("walk forward"), segment("walk forward", 0.3), segment("turn left")});
  CHECK(figures.segments == 2);
  CHECK(figures.elsewhere == 1);
  CHECK((figures.hovering >= 0 && figures.hovering <= 1));
}

TEST_CASE("a verb counts the recordings whose captions say it") {
  const auto figures = ml::judge_recordings({segment("walk forward"), segment("walk forward"), segment("turn left")});
  bool walked = false, turned = false;
  for (const ml::RecordedVerb& v : figures.verbs) {
    CHECK(v.done <= v.segments);
    CHECK(v.speed.size() == v.segments);
    CHECK(v.why_not.size() == v.segments - v.done);
    if (v.name == "walk") walked = v.segments == 2;
    if (v.name == "turn left") turned = v.segments == 1 && v.done == 0;  // the figure walks ahead
  }
  CHECK(walked);
  CHECK(turned);
  for (std::size_t m = 0; m < 4; ++m) CHECK(figures.measures[m].values.size() == 3);  // others are of flights
}
