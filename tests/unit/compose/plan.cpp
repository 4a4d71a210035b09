// The integers of a composition: the worked example, properties on random timelines, options, errors. What the
// reference computes is in the golden cases.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include <motionlang/compose/describe_plan.hpp>
#include <motionlang/compose/plan.hpp>
#include <motionlang/compose/plan_options.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/core/numpy_random.hpp>
#include <motionlang/core/python_random.hpp>

namespace ml = motionlang;
using enum ml::BodyPart;

namespace {

const ml::Timeline worked_example{{{"A", 0, 60, ml::BodyParts{}.with(legs)},
                                   {"B", 60, 100, ml::BodyParts{}.with(legs).with(spine)},
                                   {"C", 30, 80, ml::BodyParts{}.with(right_arm)}}};  // checked by hand

std::vector<ml::Slice> of_part(const std::vector<ml::Slice>& slices, ml::BodyPart part) {
  std::vector<ml::Slice> out;
  for (const auto& s : slices) {
    if (s.part == part) out.push_back(s);
  }
  return out;
}

/// One to six texts in 60 frames, at least one of them everywhere.
ml::Timeline random_timeline(ml::PythonRandom& rng) {
  ml::Timeline t;
  const ml::Index texts = rng.randint(1, 6);
  for (ml::Index i = 0; i < texts; ++i) {
    const ml::Index start = i == 0 ? 0 : rng.randint(0, 58), end = rng.randint(start + 1, 60);
    t.intervals.push_back({std::to_string(i), start, end, {static_cast<unsigned>(rng.below(32))}});
  }
  return t;
}

void check_timeline_error(const ml::Timeline& t, const ml::PlanOptions& options, const std::string& message) {
  CHECK_THROWS_WITH_AS(ml::plan_timeline(t, options), doctest::Contains(message.c_str()), ml::timeline_error);
}

ml::Timeline parsed(const char* text) { return ml::parse_timeline(text, {.fps = 1, .as_published = true}); }

}  // namespace

TEST_CASE("the worked example of the specification") {
  const auto plan = ml::plan_timeline(worked_example, {.overlap = 10});
  CHECK(plan.frames == 100);
  CHECK(plan.crops == std::vector<ml::Crop>{{0, {0, 65}},
                                            {1, {55, 100}},
                                            {2, {25, 85}},  //
                                            {-1, {25, 35}},
                                            {-1, {55, 65}},
                                            {-1, {75, 85}}});
  CHECK(plan.text(plan.crops[1]) == "B");
  CHECK(plan.text(plan.crops[3]) == "");
  CHECK(of_part(plan.add, right_arm) == std::vector<ml::Slice>{{right_arm, 0, {0, 35}, {0, 35}},
                                                               {right_arm, 2, {0, 60}, {25, 85}},
                                                               {right_arm, 1, {20, 45}, {75, 100}}});
  CHECK(of_part(plan.subtract, right_arm) ==
        std::vector<ml::Slice>{{right_arm, 3, {0, 10}, {25, 35}}, {right_arm, 5, {0, 10}, {75, 85}}});
  for (ml::BodyPart p : {left_arm, legs, head, spine}) {
    CHECK(of_part(plan.add, p) == std::vector<ml::Slice>{{p, 0, {0, 65}, {0, 65}}, {p, 1, {0, 45}, {55, 100}}});
    CHECK(of_part(plan.subtract, p) == std::vector<ml::Slice>{{p, 4, {0, 10}, {55, 65}}});
  }
}

TEST_CASE("odd overlaps have their longer half on the right") {
  for (auto [total, left, right] :
       {std::array<ml::Index, 3>{5, 2, 3}, {15, 7, 8}, {25, 12, 13}, {0, 0, 0}, {1, 0, 1}}) {
    CHECK(ml::Overlap::of_frames(total).left == left);
    CHECK(ml::Overlap::of_frames(total).right == right);
  }
  CHECK(ml::Overlap::of_seconds(0.75, 20).right == 8);
  CHECK_THROWS_WITH_AS(ml::Overlap::of_frames(-1), doctest::Contains("[motionlang.config.101]"), ml::config_error);
}

TEST_CASE("every frame of every part counts once, on random timelines and for all overlaps") {
  ml::PythonRandom rng(1);
  for (int round = 0; round < 300; ++round) {
    const ml::Timeline timeline = random_timeline(rng);
    for (ml::Index overlap : {0, 1, 5, 10, 33, 200}) {
      ml::PlanOptions options{.overlap = overlap, .hidden = ml::HiddenTexts::ignore};
      const auto plan = ml::plan_timeline(timeline, options);
      const auto net = ml::net_weights(plan);
      REQUIRE(net.smallest == 1);
      REQUIRE(net.largest == 1);
      for (const auto* slices : {&plan.add, &plan.subtract}) {
        for (const ml::Slice& s : *slices) {
          REQUIRE(s.from.size() == s.to.size());
          REQUIRE(s.from.start >= 0);
          REQUIRE(s.from.end <= plan.crops[static_cast<std::size_t>(s.crop)].range.size());
        }
      }
      // merged stretches tile the timeline, neighbours differ
      for (std::size_t i = 1; i < plan.merged.size(); ++i) {
        const auto &a = plan.merged[i - 1], &b = plan.merged[i];
        if (a.part == b.part) {
          REQUIRE(a.range.end == b.range.start);
          REQUIRE(a.owner != b.owner);
        } else {
          REQUIRE(a.range.end == plan.frames);
          REQUIRE(b.range.start == 0);
        }
      }
    }
  }
}

TEST_CASE("weights are not 1 if only one half of the method is switched on") {
  CHECK(ml::net_weights(ml::plan_timeline(worked_example, {.transition_crops = false})).largest == 2);
  CHECK(ml::net_weights(ml::plan_timeline(worked_example, {.extend = false})).smallest == 0);
  const auto sinc = ml::plan_timeline(worked_example, {.extend = false, .transition_crops = false});
  CHECK(ml::net_weights(sinc).largest == 1);
  CHECK(ml::net_weights(sinc).smallest == 1);
  CHECK(sinc.subtract.empty());
  CHECK(sinc.lerp.size() == 6);
  CHECK(sinc.crops == std::vector<ml::Crop>{{0, {0, 60}}, {1, {60, 100}}, {2, {30, 80}}});
}

TEST_CASE("fewer parts win, among equals the later text; the base has legs") {
  const auto owners = [](const ml::Timeline& t) { return ml::plan_timeline(t).owners.at(0); };
  CHECK(owners(parsed("a # 0 # 9 # legs # left arm\nb # 0 # 9 # left arm # right arm # head\nc # 0 # 9 # head")) ==
        ml::PartOwners{1, 1, 0, 2, 0});
  CHECK(owners(parsed("a # 0 # 9 # head\nb # 0 # 9 # head\nc # 0 # 9 # legs")) == ml::PartOwners{2, 2, 2, 1, 2});
  CHECK(owners(parsed("a # 0 # 9 # head\nb # 0 # 9 # head # spine")) == ml::PartOwners{1, 1, 1, 0, 1});
  CHECK(owners(parsed("a # 0 # 9\nb # 0 # 9")) == ml::PartOwners{0, 0, 0, 0, 0});
}

TEST_CASE("ties: the first text by default, any with a generator") {
  const auto t = parsed("a # 0 # 9 # legs\nb # 0 # 9 # legs\nc # 0 # 9 # legs");
  CHECK(ml::plan_timeline(t).owners[0][0] == 0);
  std::array<int, 3> bases{};
  ml::PythonRandom python(3);
  ml::NumpyRandom numpy(3);
  for (int i = 0; i < 50; ++i) {
    ++bases[static_cast<std::size_t>(ml::plan_timeline(t, {}, python).owners[0][0])];
    ++bases[static_cast<std::size_t>(ml::plan_timeline(t, {}, numpy).owners[0][0])];
  }
  for (int count : bases) CHECK(count > 10);
}

TEST_CASE("gaps are filled with the unconditional text, or refused") {
  const auto t = parsed("a # 0 # 10 # legs\nb # 30 # 50 # head\nc # 60 # 70 # head");
  const auto plan = ml::plan_timeline(t);
  REQUIRE(plan.timeline.intervals.size() == 5);
  CHECK(plan.timeline.intervals[3] == ml::Interval{"", 10, 30, ml::BodyParts::all()});
  CHECK(plan.timeline.intervals[4] == ml::Interval{"", 50, 60, ml::BodyParts::all()});
  CHECK(plan.owners[1] == ml::PartOwners{3, 3, 3, 3, 3});
  CHECK(ml::net_weights(plan).smallest == 1);
  check_timeline_error(t, {.gaps = ml::Gaps::refuse},
                       "[motionlang.timeline.505] plan_timeline: no text covers frames 10 to 30");

  const ml::Timeline late{{{"a", 5, 9, ml::BodyParts{}.with(legs)}}};
  CHECK(ml::plan_timeline(late).timeline.intervals[1] == ml::Interval{"", 0, 5, ml::BodyParts::all()});
  check_timeline_error(late, {.gaps = ml::Gaps::refuse}, "505] plan_timeline: no text covers frames 0 to 5");
  check_timeline_error({{{"a", 5, 5, {}}}}, {.gaps = ml::Gaps::refuse}, "505]");
  CHECK(ml::plan_timeline({{{"a", 5, 5, {}}}}, {.hidden = ml::HiddenTexts::ignore}).frames == 5);
}

TEST_CASE("hidden texts are reported, or their transitions left out") {
  const auto t = parsed("walk # 0 # 30 # legs\nblink # 10 # 20");
  check_timeline_error(
      t, {},
      "[motionlang.timeline.506] plan_timeline: 'blink' (10 to 20) owns no body part at frame 10: other texts hide it; "
      "give it parts that no text with fewer parts takes (line 2, column 1)");
  const auto plan = ml::plan_timeline(t, {.hidden = ml::HiddenTexts::ignore});
  CHECK(plan.crops == std::vector<ml::Crop>{{0, {0, 30}}, {1, {5, 25}}});
  CHECK(plan.add.size() == 5);
  check_timeline_error(parsed("walk # 0 # 30 # legs\nnothing # 10 # 10 # head"), {}, "506]");
}

TEST_CASE("timelines that cannot be planned") {
  check_timeline_error({}, {}, "[motionlang.timeline.507]");
  check_timeline_error({{{"a", 0, 0, {}}}}, {}, "[motionlang.timeline.504]");
  check_timeline_error({{{"a", 0, 9, {}}, {"b", 5, 4, {}}}}, {}, "504] plan_timeline: 'b' (5 to 4)");
  check_timeline_error({{{"a", -1, 9, {}}}}, {}, "504]");
  check_timeline_error({{{"a", 0, ml::latest_time + 1, {}}}}, {}, "504]");
  check_timeline_error(worked_example, {.longest_crop = 64},
                       "[motionlang.timeline.508] timeline: 'A' needs a crop of 65 frames");
  CHECK_NOTHROW(ml::plan_timeline(worked_example, {.longest_crop = 65}));
  check_timeline_error(parsed("a # 0 # 30 # legs\n  b # 10 # 60 # head"), {.longest_crop = 54},
                       "508] timeline: 'b' needs a crop of 55 frames with its overlap; the denoiser accepts 54 (line "
                       "2, column 3). Divide it into shorter ones");
  CHECK_THROWS_AS(ml::plan_timeline(worked_example, {.overlap = -1}), ml::config_error);
  ml::Timeline crowd;
  for (ml::Index i = 0; i < 4000; ++i) crowd.intervals.push_back({"x", i, 8000 - i, {}});
  CHECK_THROWS_WITH_AS(ml::plan_timeline(crowd), doctest::Contains("[motionlang.config.101]"), ml::config_error);
}

TEST_CASE("a batch numbers the crops of its timelines one after the other, with one generator") {
  const std::vector<ml::Timeline> timelines{worked_example, parsed("a # 0 # 120 # legs"), worked_example};
  const auto batch = ml::plan_timelines(timelines);
  CHECK(batch.first_crop == std::vector<ml::Index>{0, 6, 7, 13});
  CHECK(batch.crops() == 13);
  CHECK(batch.frames == 120);
  CHECK(batch.timelines[2].add == batch.timelines[0].add);
  CHECK(ml::plan_timelines({}).crops() == 0);
}

TEST_CASE("a plan as lines: each text with its body parts, each body part with the texts that move it") {
  const std::string text = ml::describe_plan(ml::plan_timeline(worked_example, {.overlap = 10}), 20);
  CHECK(text ==
        "    0.00 -   3.00 s  A                                        legs\n"
        "    3.00 -   5.00 s  B                                        legs, spine\n"
        "    1.50 -   4.00 s  C                                        right arm\n"
        "  left arm   [0.00-3.00 A] [3.00-5.00 B]\n"
        "  right arm  [0.00-1.50 A] [1.50-4.00 C] [4.00-5.00 B]\n"
        "  legs       [0.00-3.00 A] [3.00-5.00 B]\n"
        "  head       [0.00-3.00 A] [3.00-5.00 B]\n"
        "  spine      [0.00-3.00 A] [3.00-5.00 B]\n");
  const ml::BodyPartition robot({.names = {"base", "gripper"}, .path = "base"});
  const ml::Timeline pick{{{"pick", 0, 40, robot.all()}}, robot};
  CHECK(ml::describe_plan(ml::plan_timeline(pick), 20).find("\n  gripper    [0.00-2.00 pick]\n") != std::string::npos);
}
