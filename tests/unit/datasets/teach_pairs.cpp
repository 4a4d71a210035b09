// TEACH: pairs of actions out of overlapping segments, their frames, which are long enough.
#include <doctest/doctest.h>

#include <motionlang/datasets/teach_pairs.hpp>

namespace ml = motionlang;
using Segments = std::vector<ml::BabelSegment>;
using Pairs = std::vector<ml::ActionPair>;

namespace {

/// An annotated sequence as BABEL has them, not in order.
const Segments example{{0, 30, "t-pose"},         {135, 195, "turn left"},      {27, 42, "transition"},
                       {39, 150, "walk forward"}, {60, 120, "wave right hand"}, {186, 225, "transition"},
                       {210, 270, "sit down"},    {270, 330, "stand up"}};

}  // namespace

TEST_CASE("TEACH pairs: the example of the specification") {
  const Pairs pairs = ml::teach_pairs(example);
  REQUIRE(pairs.size() == 3);
  CHECK(pairs[0] == ml::ActionPair{{39, 150, "walk forward"}, std::nullopt, {135, 195, "turn left"}});
  CHECK(pairs[1] == ml::ActionPair{{135, 195, "turn left"}, {{186, 225, "transition"}}, {210, 270, "sit down"}});
  CHECK(pairs[2] == ml::ActionPair{{210, 270, "sit down"}, std::nullopt, {270, 330, "stand up"}});
  CHECK(pairs[0].frames() ==
        ml::PairFrames{{39, 158}, std::nullopt, {158, 195}});  // half of the overlap behind the end
  CHECK(pairs[1].frames() == ml::PairFrames{{135, 187}, {{187, 210}}, {210, 270}});
  CHECK(pairs[2].frames() == ml::PairFrames{{210, 271}, std::nullopt, {271, 330}});
  CHECK(pairs[1].frames().all() == ml::FrameRange{135, 270});
  CHECK(pairs[1].frames().transition_size() == 23);
  CHECK(pairs[2].frames().transition_size() == 0);
}

TEST_CASE("TEACH pairs: transitions") {
  const auto count = [](const Segments& s) { return ml::teach_pairs(s).size(); };
  const ml::BabelSegment a{0, 20, "a"}, b{40, 60, "b"};
  CHECK(count({a, {20, 40, "transition"}, b}) == 1);
  CHECK(count({{0, 40, "transition"}, b}) == 0);
  CHECK(count({{1, 40, "transition"}, b}) == 0);  // nothing before it
  CHECK(count({a, {15, 40, "t-pose"}, b}) == 0);
  // touching actions: the transition between them is not part of its own
  const Pairs touching = ml::teach_pairs(Segments{{0, 30, "a"}, {20, 35, "transition"}, {26, 60, "b"}});
  REQUIRE(touching.size() == 2);
  CHECK(touching[0] == ml::ActionPair{{0, 30, "a"}, std::nullopt, {26, 60, "b"}});
  CHECK(touching[1].transition == ml::BabelSegment{20, 35, "transition"});
  CHECK(touching[1].frames() ==
        ml::PairFrames{{0, 29}, std::nullopt, {29, 60}});  // and parts at half the overlap before
}

TEST_CASE("TEACH pairs: of several segments with the same times the last text counts, each pair once") {
  const Pairs pairs = ml::teach_pairs(Segments{{0, 20, "a"}, {20, 40, "b"}, {0, 20, "c"}});
  REQUIRE(pairs.size() == 1);
  CHECK(pairs[0].first.text == "c");
}

TEST_CASE("TEACH pairs: lengths, and both actions as one") {
  const ml::PairFrames short_second{{0, 20}, {{20, 24}}, {24, 34}};
  CHECK_FALSE(ml::is_teach_length(short_second));
  CHECK(ml::is_teach_length(short_second, {.shortest = 14}));
  CHECK_FALSE(ml::is_teach_length({{0, 751}, std::nullopt, {751, 800}}));
  CHECK(ml::is_teach_length({{0, 751}, std::nullopt, {751, 800}}, {.longest = 100000}));
  CHECK(ml::joined_pairs(ml::teach_pairs(example)) == Segments{{39, 195, "walk forward, turn left"},
                                                               {135, 270, "turn left, sit down"},
                                                               {210, 330, "sit down, stand up"}});
  const ml::ActionPair p{{0, 20, "a"}, std::nullopt, {20, 40, "b"}}, q{{0, 20, "c"}, std::nullopt, {20, 40, "d"}};
  CHECK(ml::joined_pairs(Pairs{p, q}) == Segments{{0, 40, "a, b"}});
}
