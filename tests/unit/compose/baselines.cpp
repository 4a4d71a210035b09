// The timelines of the baselines: one track, one sentence. Numbers of the published ones are golden cases.
#include <doctest/doctest.h>

#include <motionlang/compose/baselines.hpp>

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
