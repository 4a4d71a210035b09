// The timelines of the baselines: one track, one sentence. Numbers of the published ones are golden cases.
#include <doctest/doctest.h>

#include <motionlang/compose/baselines.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using enum ml::BodyPart;
using ml::BodyParts, ml::TimelineInSeconds;

namespace {

const auto only_legs = BodyParts{}.with(legs), only_arm = BodyParts{}.with(left_arm);
const auto both = only_legs.with(left_arm);
const TimelineInSeconds crossing{{{"walk", 0, 6, only_legs}, {"wave", 4, 8, only_arm}, {"sit", 9, 20, only_legs}}};

}  // namespace

TEST_CASE("one track joins what happens at the same time and leaves gaps out") {
  CHECK(ml::single_track(crossing) == TimelineInSeconds{{{"walk", 0, 4, only_legs},
                                                         {"walk while wave", 4, 6, both},
                                                         {"wave", 6, 8, only_arm},
                                                         {"sit", 9, 20, only_legs}}});
  CHECK(ml::single_track({}).intervals.empty());
}

TEST_CASE("one sentence for everything, at most 9.8 seconds") {
  CHECK(ml::one_text(crossing) == TimelineInSeconds{{{"walk and then wave while sit", 0, 9.8, both}}});
  CHECK(ml::one_text({{{"walk", 1, 3, only_legs}}}) == TimelineInSeconds{{{"walk", 0, 2, only_legs}}});
  CHECK(ml::one_text({}).intervals.empty());
}

TEST_CASE("modes have names, and timelines of their own") {
  for (const ml::StmcMode mode : ml::stmc_modes) CHECK(ml::parse_stmc_mode(ml::to_string(mode)) == mode);
  CHECK(ml::to_string(ml::StmcMode::sinc_lerp) == "sinc-lerp");
  CHECK_ERROR(ml::parse_stmc_mode("best"),
              "[motionlang.config.103] mode 'best' is not one of stmc, sinc, sinc-lerp, single-track, one-text");
  const ml::Timeline frames = ml::to_frames(crossing, 20);
  for (const auto mode : {ml::StmcMode::stmc, ml::StmcMode::sinc, ml::StmcMode::sinc_lerp})
    CHECK(ml::timeline_of_mode(mode, frames, 20) == frames);
  CHECK(ml::timeline_of_mode(ml::StmcMode::single_track, frames, 20) == ml::to_frames(ml::single_track(crossing), 20));
  CHECK(ml::timeline_of_mode(ml::StmcMode::one_text, frames, 20).intervals.front().end == 196);
  // cuts of 12.5 frames per second that no decimal number of seconds has exactly
  const ml::Timeline odd{{{"walk", 0, 7, only_legs}, {"wave", 3, 11, only_arm}}};
  const auto single = ml::timeline_of_mode(ml::StmcMode::single_track, odd, 12.5);
  REQUIRE(single.intervals.size() == 3);
  CHECK((single.intervals[1].start == 3 && single.intervals[1].end == 7 && single.intervals[2].end == 11));
}
