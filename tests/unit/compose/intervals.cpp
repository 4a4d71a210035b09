// Cutting timelines, who owns which part, overlap around cuts, frames and seconds.
#include <motionlang/compose/intervals.hpp>
#include <motionlang/compose/overlap.hpp>
#include <motionlang/compose/sinc_assignment.hpp>
#include <motionlang/core/python_random.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using enum ml::BodyPart;
using ml::BodyParts, ml::FrameRange, ml::Index, ml::Overlap, ml::Piece, ml::Timeline;
using List = std::vector<Index>;

namespace {

Timeline with_parts(std::initializer_list<BodyParts> parts) {
  Timeline t;
  for (const BodyParts& p : parts) t.intervals.push_back({"", 0, 10, p});
  return t;
}

/// Owners of left arm, right arm, legs, head, spine when all texts are active.
ml::PartOwners owners(const Timeline& t) {
  List all;
  for (Index i = 0; i < std::ssize(t.intervals); ++i) all.push_back(i);
  ml::FirstWins ties;
  return ml::assign_parts(t, all, ties);
}

const BodyParts arms = BodyParts{}.with(left_arm).with(right_arm), lower = BodyParts{}.with(legs).with(spine);

}  // namespace

TEST_CASE("pieces lie between neighbouring cuts; intervals in file order") {
  const Timeline t{{{"c", 4, 8, {}}, {"a", 0, 6, {}}, {"b", 10, 12, {}}}};
  CHECK(ml::elementary_pieces(t) ==
        std::vector<Piece>{{0, 4, {1}}, {4, 6, {0, 1}}, {6, 8, {0}}, {8, 10, {}}, {10, 12, {2}}});
  CHECK(ml::elementary_pieces(Timeline{}).empty());
  const Timeline same{{{"a", 0, 5, {}}, {"b", 0, 5, {}}}};
  CHECK(ml::elementary_pieces(same) == std::vector<Piece>{{0, 5, {0, 1}}});
  const Timeline empty_one{{{"a", 0, 5, {}}, {"nothing", 3, 3, {}}}};
  CHECK(ml::elementary_pieces(empty_one) == std::vector<Piece>{{0, 3, {0}}, {3, 5, {0}}});
}

TEST_CASE("thousands of texts over each other are refused before they fill the memory") {
  Timeline nested;
  for (Index i = 0; i < 4000; ++i) nested.intervals.push_back({"", i, 10000 - i, {}});
  CHECK_ERROR(ml::elementary_pieces(nested), "[motionlang.config.101] elementary_pieces: too many of 4000 intervals");
}

TEST_CASE("gaps are filled with the unconditional text, from 0 to the end") {
  Timeline t{{{"b", 7, 9, {}}, {"a", 2, 5, {}}, {"c", 3, 6, {}}}};
  ml::fill_gaps(t);
  REQUIRE(t.intervals.size() == 5);
  CHECK(t.intervals[3] == ml::Interval{"", 0, 2, BodyParts::all()});
  CHECK(t.intervals[4] == ml::Interval{"", 6, 7, BodyParts::all()});
  const auto full = t;
  ml::fill_gaps(t);
  CHECK(t == full);
}

TEST_CASE("the base text gets everything that nobody takes away; fewer parts win, of equals the later text") {
  CHECK(owners(with_parts({arms})) == ml::PartOwners{0, 0, 0, 0, 0});
  CHECK(owners(with_parts({arms, lower})) == ml::PartOwners{0, 0, 1, 1, 1});  // the one with legs is the base
  CHECK(owners(with_parts({lower, arms})) == ml::PartOwners{1, 1, 0, 0, 0});
  CHECK(owners(with_parts({BodyParts::all(), lower, arms})) == ml::PartOwners{2, 2, 1, 0, 1});
  CHECK(owners(with_parts({lower, arms, BodyParts{}.with(left_arm)})) == ml::PartOwners{2, 1, 0, 0, 0});
  CHECK(owners(with_parts({lower, arms, arms})) == ml::PartOwners{2, 2, 0, 0, 0});
  CHECK(owners(with_parts({lower, lower})) == ml::PartOwners{0, 0, 1, 0, 1});  // the first base, the later text
  CHECK(owners(with_parts({{}, {}})) == ml::PartOwners{0, 0, 0, 0, 0});
}

TEST_CASE("equal base texts are shuffled when a generator is given, as published") {
  const auto t = with_parts({lower, lower});
  const List both{0, 1};
  ml::PythonRandom rng(1);
  int second = 0;
  for (int i = 0; i < 100; ++i) second += ml::assign_parts(t, both, rng)[0] == 1;
  CHECK(second > 30);
  CHECK(second < 70);
}

TEST_CASE("an odd overlap is longer to the right, and stays inside the motion") {
  const Overlap o = Overlap::of_frames(5);
  CHECK(o.left == 2);
  CHECK(o.right == 3);
  CHECK(o.extend({10, 20}, 100) == FrameRange{8, 23});
  CHECK(o.extend({1, 99}, 100) == FrameRange{0, 100});
  CHECK(o.window(50, 100) == FrameRange{48, 53});
  CHECK(Overlap::of_frames(0).window(50, 100).size() == 0);
  CHECK(Overlap::of_seconds(0.5, 20).right == 5);
  CHECK_ERROR(Overlap::of_frames(-1), "[motionlang.config.101] Overlap: -1 frames");
  CHECK_ERROR(Overlap::of_frames(ml::latest_time + 1), "[motionlang.config.101]");
}

TEST_CASE("seconds to frames truncates as published; frames to seconds and back is exact") {
  CHECK(ml::frame_at(0.29, 100) == 28);  // 0.29 * 100 is below 29 in double
  CHECK(ml::frame_at(-0.99, 1) == 0);
  CHECK_ERROR(ml::frame_at(1e300, 20), "[motionlang.config.101] frame_at");
  CHECK_ERROR(ml::frame_at(std::nan(""), 20), "[motionlang.config.101]");
  for (double fps : {20.0, 30.0, 12.5, 29.97, 1000.0 / 3}) {
    Timeline t{{{"first", 0, 1, {}}}};
    for (Index f = 1; f < 500; ++f) t.intervals.push_back({"", f, 2 * f, {}});
    CHECK(ml::to_frames(ml::to_seconds(t, fps), fps) == t);
  }
  const ml::TimelineInSeconds late{{{"a", 3, 4, {}}, {"b", 2.5, 3, {}}}};
  CHECK(ml::to_frames(late, 10) == Timeline{{{"a", 5, 15, {}}, {"b", 0, 5, {}}}});
}
