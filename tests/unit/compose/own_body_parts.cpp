// Timelines, plans and collages of other bodies than the human one.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/body_part_lexicon.hpp>
#include <motionlang/compose/collage.hpp>
#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/compose/edits.hpp>
#include <motionlang/compose/handovers.hpp>
#include <motionlang/compose/in_turn.hpp>
#include <motionlang/compose/long_texts.hpp>
#include <motionlang/compose/stitching.hpp>
#include <motionlang/compose/timeline_text.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::BodyPart, ml::BodyParts, ml::BodyPartition, ml::Index, ml::PartOwners, ml::Timeline;

namespace {

const BodyPartition dog({.names = {"front left", "front right", "hind left", "hind right", "trunk"},
                         .path = "trunk",
                         .synonyms = {{"tail", "trunk"}},
                         .words = {{"dig", {"front left", "front right"}}, {"wag", {"trunk"}}}});
/// More parts than a human has. The base carries the path and is the first part.
const BodyPartition robot({.names = {"base", "mast", "arm 1", "arm 2", "arm 3", "gripper", "lamp", "camera"},
                           .path = "base"});

Timeline parsed(std::string_view text, const BodyPartition& body = dog) {
  return ml::parse_timeline(text, {.fps = 1, .name = "dog.txt", .body = body});
}
PartOwners owners(std::string_view text, const BodyPartition& body = dog) {
  return ml::plan_timeline(parsed(text, body)).owners.at(0);
}

}  // namespace

TEST_CASE("own parts are read by name and synonym; without parts the whole of that body moves") {
  const Timeline t = parsed("trot # 0 # 9\nshake hands # 1 # 3 # front left\nwag # 2 # 5 # tail # hind left\n");
  CHECK(t.body == dog);
  CHECK(t.intervals == std::vector<ml::Interval>{{"trot", 0, 9, dog.all()},
                                                 {"shake hands", 1, 3, dog.parts({"front left"})},
                                                 {"wag", 2, 5, dog.parts({"trunk", "hind left"})}});
  CHECK(parsed("wave # 0 # 1", robot).intervals[0].parts.count() == 8);
  CHECK(ml::is_text_list("bark # 2 # tail", {.body = dog}));
  CHECK_FALSE(ml::is_text_list("bark # 2 # tail"));
  CHECK(ml::parse_text_list("bark # 2 # tail", {.fps = 1, .body = dog}) == std::vector<ml::TimedText>{{"bark", 2}});
}

TEST_CASE("parts of another body are refused where they stand, with the names of this one") {
  CHECK_ERROR(
      parsed("trot # 0 # 9\nwave # 0 # 1 # left arm"),
      "[motionlang.timeline.503] dog.txt:2:16: 'left arm' is not a body part (front left, front right, hind left, "
      "hind right, trunk)");
  CHECK_ERROR(ml::parse_timeline("trot # 0 # 9 # trunk"),
              "'trunk' is not a body part (left arm, right arm, legs, head, spine)");
  CHECK_ERROR(ml::parse_text_list("bark # 2 # legs", {.name = "list", .body = dog}),
              "[motionlang.timeline.503] list:1:12: 'legs' is not a body part (front left");
  CHECK_ERROR(ml::plan_timeline({{{"wave", 0, 9, robot.all()}}, dog}),
              "[motionlang.timeline.503] plan_timeline: 'wave' (0 to 9) moves other body parts than front left, front "
              "right, hind left, hind right, trunk (with the path)");
  CHECK_ERROR(ml::plan_timeline({{{"wave", 0, 9, BodyParts::every()}}}), "[motionlang.timeline.503]");
  CHECK(ml::plan_timeline({{{"wave", 0, 9, robot.all()}}, robot}).owners.at(0) == PartOwners(8));
}

TEST_CASE("what is written is in alphabetical order and is read back") {
  const std::string text =
      "trot # 0.0 # 9.0 # front left # front right # hind left # hind right # trunk\n"
      "wag # 2.0 # 5.0 # hind left # trunk\n\n";
  const auto timelines = ml::parse_timelines_in_seconds(text, {.body = dog});
  CHECK(ml::write_timelines(timelines) == text);
  const auto of_robot = ml::parse_timelines_in_seconds("turn # 0 # 1 # mast # camera # base", {.body = robot});
  CHECK(ml::write_timelines(of_robot) == "turn # 0.0 # 1.0 # base # camera # mast\n\n");
}

TEST_CASE("the base text is one with the part that carries the path") {
  CHECK(owners("kick # 0 # 9 # hind left # hind right\ntrot # 0 # 9 # trunk") == PartOwners{1, 1, 0, 0, 1});
  CHECK(owners("trot # 0 # 9\nkick # 0 # 9 # hind left # hind right\nshake # 0 # 9 # hind left") ==
        PartOwners{0, 0, 2, 1, 0});
  // of all, if none has it: the one with the most parts
  CHECK(owners("kick # 0 # 9 # hind left # hind right\nshake # 0 # 9 # front left") == PartOwners{1, 0, 0, 0, 0});
  // The same bits on the human body: there the path is the third part.
  const Timeline human{{{"a", 0, 9, {0b01100}}, {"b", 0, 9, {0b10000}}}};
  CHECK(ml::plan_timeline(human).owners.at(0) == PartOwners{0, 0, 0, 0, 1});
  CHECK(ml::plan_timeline({human.intervals, dog}).owners.at(0) == PartOwners{1, 1, 0, 0, 1});
  CHECK(owners("drive # 0 # 9 # base\nlook # 0 # 9 # mast # lamp # camera\nlight # 0 # 9 # lamp", robot) ==
        PartOwners{0, 1, 0, 0, 0, 0, 2, 1});
}

TEST_CASE("plans of own bodies add every frame of every part once, and fill gaps for all of them") {
  for (const Index overlap : {0, 4, 11}) {
    const auto plan = ml::plan_timeline(
        parsed("drive # 0 # 40 # base\nlook # 10 # 30 # mast # camera\nlight # 20 # 35 # lamp\ndrive # 50 # 60", robot),
        {.overlap = overlap});
    CHECK(plan.timeline.body == robot);
    CHECK(plan.timeline.intervals.back() == ml::Interval{"", 40, 50, robot.all()});
    CHECK(ml::net_weights(plan).smallest == 1);
    CHECK(ml::net_weights(plan).largest == 1);
    int parts = 0;
    for (const ml::PartInterval& m : plan.merged) parts = std::max(parts, static_cast<int>(m.part) + 1);
    CHECK(parts == 8);
  }
}

TEST_CASE("a body of 32 parts") {
  ml::BodyPartNames names{.names = {}, .path = "segment 31"};
  for (int p = 0; p < 32; ++p) names.names.push_back("segment " + std::to_string(p));
  const BodyPartition snake(names);
  const auto plan = ml::plan_timeline(parsed("crawl # 0 # 9\nraise # 2 # 5 # segment 0 # segment 31", snake));
  CHECK(plan.owners.at(1).front() == 1);
  CHECK(plan.owners.at(1).back() == 1);
  CHECK(std::count(plan.owners.at(1).begin(), plan.owners.at(1).end(), 0) == 30);
  CHECK(ml::net_weights(plan).largest == 1);
}

TEST_CASE("what makes a timeline from another keeps the body") {
  const Timeline t = parsed("trot, then sit # 0 # 40\nshake # 10 # 20 # front left\n");
  CHECK(ml::cut_at_handovers(t, 1) == parsed("trot, then sit # 0 # 10\ntrot, then sit # 10 # 20\n"
                                             "trot, then sit # 20 # 40\nshake # 10 # 20 # front left\n"));
  CHECK(ml::divide_long_texts(t, 20).body == dog);
  CHECK(ml::cut_texts(t, 1).body == dog);
  CHECK(ml::in_turn(t) == parsed("trot # 0 # 20\nsit # 20 # 40\nshake # 10 # 20 # front left\n"));
  const auto seconds = ml::to_seconds(t, 20);
  CHECK(seconds.body == dog);
  CHECK(ml::to_frames(seconds, 20) == t);
  CHECK(ml::write_timeline(ml::single_track(
            ml::parse_timelines_in_seconds("trot # 0 # 2 # trunk\nshake # 1 # 2 # front left", {.body = dog})[0])) ==
        "trot # 0.0 # 1.0 # trunk\ntrot while shake # 1.0 # 2.0 # front left # trunk\n\n");
  CHECK(ml::one_text(seconds).body == dog);
  CHECK(ml::one_text({{}, dog}).body == dog);
}

TEST_CASE("a text is cut where the eighth part of a body changes its owner") {
  const Timeline t = parsed("drive # 0 # 40\nlook # 10 # 20 # camera\n", robot);
  CHECK(ml::cut_at_handovers(t, 1) ==
        parsed("drive # 0 # 10\ndrive # 10 # 20\ndrive # 20 # 40\nlook # 10 # 20 # camera\n", robot));
}

TEST_CASE("parts are guessed from names, synonyms and words") {
  const auto guess = [](std::string_view text) { return ml::guess_body_parts(text, dog); };
  CHECK(guess("Digs a hole") == dog.parts({"front left", "front right"}));
  CHECK(guess("lift the FRONT left paw") == dog.parts({"front left"}));
  CHECK(guess("wagging, hind-right foot up") == dog.parts({"hind right", "trunk"}));
  CHECK(guess("tail high") == dog.parts({"trunk"}));
  CHECK(guess("left front") == dog.all());
  CHECK(guess("walk") == dog.all());  // a word of the human lexicon
  CHECK(guess("") == dog.all());
  CHECK(ml::guess_body_parts("wave", BodyPartition()) == ml::guess_body_parts("wave"));
  CHECK(ml::guess_body_parts("turn the mast and arm 2", robot) == robot.parts({"mast", "arm 2"}));
  Timeline t{{{"dig", 0, 9, {}}, {"dig", 0, 9, dog.parts({"trunk"})}}, dog};
  ml::guess_missing_parts(t);
  CHECK(t.intervals[0].parts.bits == 3);
  CHECK(t.intervals[1].parts == dog.parts({"trunk"}));
}

TEST_CASE("a guess with a human body of own words follows these") {
  const BodyPartition human(
      {.names = {"left arm", "right arm", "legs", "head", "spine"}, .path = "legs", .words = {{"wave", {"left arm"}}}});
  CHECK(ml::guess_body_parts("wave", human) == BodyParts{}.with(BodyPart::left_arm));
}

namespace {

using B = ml::EigenBackend<double>;
using Matrix = ml::Tensor<B, 2>;
using Text = ml::TextFeatures<B>;

/// Answers with the number of the text in all features.
struct Says {
  static constexpr auto fields() { return ml::fields(); }
  ml::DenoiserTraits traits() const { return {}; }
  ml::Sequences<B> operator()(const ml::Sequences<B>& x, std::span<const Index>, const Text& text) const {
    return x.with(ml::repeat_for_rows(text.tokens.rows, x.offsets));
  }
};

Text texts(const std::vector<double>& numbers, Index features) {
  return Text::pooled(Matrix::from(numbers, {std::ssize(numbers), 1}) * Matrix::full({1, features}, 1));
}

ml::BatchPlan plan_of(const Timeline& t, const ml::PlanOptions& options = {}) {
  return ml::plan_timelines(std::span(&t, 1), options);
}
constexpr ml::PlanOptions hard_cuts{.overlap = 0, .extend = false, .transition_crops = false};

/// One feature for each part.
const auto robot_layout = ml::FeatureLayout::from_owner("robot", 8, robot, [](Index i) { return i; });

}  // namespace

TEST_CASE("a collage gives each of eight parts the frames of its owner") {
  const Timeline t = parsed("drive # 0 # 40\nlook # 10 # 20 # mast # camera\nlight # 15 # 30 # lamp", robot);
  const Says says;
  const ml::Collage<B, Says> c(says, plan_of(t, hard_cuts), robot_layout, texts({1, 2, 3}, 8), texts({0}, 8), 1);
  const auto x0 = c.step(Matrix::zeros({40, 8}), 0).x0;
  for (Index f = 0; f < 40; ++f) {
    for (Index p = 0; p < 8; ++p) {
      const bool look = f >= 10 && f < 20 && (p == 1 || p == 7), light = f >= 15 && f < 30 && p == 6;
      CHECK(x0.span()[static_cast<std::size_t>(8 * f + p)] == (look ? 2 : light ? 3 : 1));
    }
  }
  const auto smooth = ml::interpolate_transitions(
      plan_of(t, {.overlap = 4, .extend = false, .transition_crops = false}), robot_layout, x0, 40);
  CHECK(smooth.span()[8 * 9 + 7] == doctest::Approx(1 + 1.0 / 3));  // the camera between 8 and 11
  CHECK(smooth.span()[8 * 9] == 1);                                 // the base has no cut
}

TEST_CASE("every text alone moves the whole of its own body") {
  const Timeline t = parsed("drive # 0 # 40\nlook # 10 # 20 # mast # camera", robot);
  const auto alone = ml::independent_plan(plan_of(t), 0);
  REQUIRE(alone.timelines.size() == 2);
  for (const ml::TimelinePlan& p : alone.timelines) {
    CHECK(p.timeline.body == robot);
    CHECK(p.timeline.intervals.front().parts == robot.all());
    CHECK(p.add.size() == 8);
  }
}

TEST_CASE("a layout of another body is refused") {
  const Timeline t = parsed("trot # 0 # 9");
  const Says says;
  CHECK_ERROR((ml::Collage<B, Says>(says, plan_of(t), robot_layout, texts({1}, 8), texts({0}, 8), 1)),
              "[motionlang.config.102] FeatureLayout 'robot' is of a body of base (with the path), mast, ");
  const auto human = ml::FeatureLayout::from_owner("five", 5, [](Index i) { return BodyPart(i); });
  CHECK_ERROR((ml::Collage<B, Says>(says, plan_of(t), human, texts({1}, 5), texts({0}, 5), 1)),
              "the timeline's has front left, front right, hind left, hind right, trunk (with the path)");
  CHECK_ERROR(ml::interpolate_transitions(plan_of(t), human, Matrix::zeros({9, 5}), 9), "[motionlang.config.102]");
}

TEST_CASE("a timeline of another body is edited everywhere") {
  const Timeline before{{{"a", 0, 20, dog.all()}, {"b", 20, 40, dog.all()}}, dog};
  Timeline after = before;
  after.body = BodyPartition();
  CHECK(ml::EditSpread(plan_of(before), 40, plan_of(before), 40).frames() == 0);
  CHECK(ml::EditSpread(plan_of(before), 40, plan_of(after), 40).frames() == 40);
}
