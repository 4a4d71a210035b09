// Timelines and their plans as text.
#include <motionlang/compose/describe_plan.hpp>
#include <motionlang/compose/timeline_text.hpp>

#include <doctest/doctest.h>

namespace ml = motionlang;

TEST_CASE("a timeline and its plan in lines") {
  const ml::Timeline timeline = ml::parse_timeline("walk # 0 # 4\nwave\a # 1 # 2.5 # right arm\n");
  CHECK(ml::describe_timeline(timeline, 20) ==
        "timeline: 2 texts, 4.00 s\n    0.00 -   4.00 s  walk\n    1.00 -   2.50 s  wave?\n");
  const std::string plan = ml::describe_plan(ml::plan_timeline(timeline, {.overlap = 0}), 20);
  CHECK(plan.find("    1.00 -   2.50 s  wave?                                    right arm\n") != plan.npos);
  CHECK(plan.find("  right arm  [0.00-1.00 walk] [1.00-2.50 wave?] [2.50-4.00 walk]\n") != plan.npos);
  const std::string plans = ml::describe_plans(std::vector{timeline, timeline}, {.overlap = 0, .cut_texts = false});
  CHECK(plans == "timeline 0: 80 frames, 4.00 s, 2 texts\n" + plan + "timeline 1: 80 frames, 4.00 s, 2 texts\n" + plan);
  CHECK(ml::describe_plans(std::span(&timeline, 1)).find("2 texts cut into ") != std::string::npos);
  CHECK(plan.find("  legs       [0.00-4.00 walk]\n") != plan.npos);
}
