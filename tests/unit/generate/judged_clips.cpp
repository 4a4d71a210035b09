#include <motionlang/generate/judged_clips.hpp>

#include <doctest/doctest.h>

#include <motionlang/metrics/motion_trace.hpp>

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
  const auto hovers = [](const ml::CaptionedSegment& s) {
    return ml::longest_hover(ml::trace_motion(s.motion)) > ml::EyeLimits{}.hover;
  };
  CHECK(figures.hovering == (hovers(segment("walk forward")) ? 1 : 0));
  ml::CaptionedSegment flying = segment("walk forward");  // a second of three
  for (std::size_t f = 20; f < 40; ++f) flying.motion.root[f].y += 0.3;
  REQUIRE(ml::stands_on_floor(flying));
  REQUIRE(hovers(flying));
  REQUIRE_FALSE(hovers(segment("turn left")));
  CHECK(ml::judge_recordings({flying, segment("turn left")}).hovering == 0.5);
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
