// How far an edit of a timeline reaches after each step, compared with the definition: crop by crop, frame by frame.
#include <doctest/doctest.h>

#include <motionlang/compose/edits.hpp>

namespace ml = motionlang;
using ml::BodyParts, ml::Index, ml::Timeline;

namespace {

/// Texts one after the other, ten frames each.
Timeline chain(std::vector<std::string> texts) {
  Timeline t;
  for (Index i = 0; const std::string& text : texts)
    t.intervals.push_back({text, 10 * i, 10 * i + 10, BodyParts::all()}), ++i;
  return t;
}
ml::BatchPlan plan(const std::vector<Timeline>& timelines, Index overlap = 4) {
  return ml::plan_timelines(timelines, {.overlap = overlap, .hidden = ml::HiddenTexts::ignore});
}
/// First and last frame that differ, or -1, -1; there must be no hole between them.
std::pair<Index, Index> range(const ml::EditSpread& s, Index frames, std::size_t m = 0) {
  Index first = -1, last = -1, n = 0;
  for (Index f = 0; f < frames; ++f) {
    if (!s.differs(m, f)) continue;
    first = first < 0 ? f : first;
    last = f;
    ++n;
  }
  CHECK((n == 0 || n == last - first + 1));
  return {first, last};
}
std::vector<ml::FrameRange> crops_of(const ml::BatchPlan& p, std::size_t m = 0) {
  std::vector<ml::FrameRange> out;
  for (const ml::Crop& c : p.timelines[m].crops) {
    if (c.range.size() > 0) out.push_back(c.range);
  }
  return out;
}

}  // namespace

TEST_CASE("an edit goes one crop further with every step") {
  const auto before = plan({chain({"a", "b", "c", "d", "e", "f", "g"})}),
             after = plan({chain({"a", "b", "c", "X", "e", "f", "g"})});
  ml::EditSpread s(before, 70, after, 70);
  CHECK(range(s, 70) == std::pair<Index, Index>{28, 41});  // the crop of X: 30 to 40 and two frames on each side
  // the frames of X are made of its crop, of its neighbours and of the transitions on both sides
  CHECK(crops_of(s.needed()) == std::vector<ml::FrameRange>{{18, 32}, {28, 42}, {38, 52}, {28, 32}, {38, 42}});
  CHECK(s.advance());
  CHECK(range(s, 70) == std::pair<Index, Index>{18, 51});
  CHECK(s.advance());
  CHECK(range(s, 70) == std::pair<Index, Index>{8, 61});
  CHECK_FALSE(s.everywhere());
  CHECK(s.advance());
  CHECK(range(s, 70) == std::pair<Index, Index>{0, 69});
  CHECK(s.everywhere());
  CHECK_FALSE(s.advance());
  CHECK_FALSE(s.limited());
  CHECK(crops_of(s.needed()) == crops_of(after));
}

TEST_CASE("nothing edited, nothing differs; a timeline of the batch keeps to itself") {
  const auto a = chain({"a", "b", "c"}), b = chain({"d", "e"});
  ml::EditSpread same(plan({a, b}), 30, plan({a, b}), 30);
  CHECK(same.frames() == 0);
  CHECK_FALSE(same.advance());
  CHECK(crops_of(same.needed()).empty());
  ml::EditSpread second(plan({a, b}), 30, plan({a, chain({"d", "X"})}), 30);
  CHECK(second.advance());
  CHECK(range(second, 30, 0).first == -1);
  CHECK(range(second, 20, 1) == std::pair<Index, Index>{0, 19});
  CHECK(second.everywhere());
  CHECK(crops_of(second.needed(), 0).empty());
  ml::EditSpread added(plan({a}), 30, plan({a, b}), 30);
  CHECK(range(added, 30, 0).first == -1);
  CHECK(range(added, 20, 1) == std::pair<Index, Index>{0, 19});
}

TEST_CASE("the order of the texts in the file is not an edit where it decides nothing") {
  auto turned = chain({"a", "b", "c"});
  std::swap(turned.intervals[0], turned.intervals[2]);
  CHECK(ml::EditSpread(plan({chain({"a", "b", "c"})}), 30, plan({turned}), 30).frames() == 0);
}

TEST_CASE("without overlap an edit stops at the cuts that nothing spans") {
  ml::EditSpread s(plan({chain({"a", "b", "c"})}, 0), 30, plan({chain({"a", "X", "c"})}, 0), 30);
  CHECK(range(s, 30) == std::pair<Index, Index>{10, 19});
  CHECK_FALSE(s.advance());
  CHECK(crops_of(s.needed()) == std::vector<ml::FrameRange>{{10, 20}});
  // a second track over the cut carries it on
  const auto track = [&](const char* text) {
    auto t = chain({"a", text, "c"});
    t.intervals.push_back({"arm", 15, 25, BodyParts{}.with(ml::BodyPart::left_arm)});
    return t;
  };
  ml::EditSpread over(plan({track("b")}, 0), 30, plan({track("X")}, 0), 30);
  CHECK(range(over, 30) == std::pair<Index, Index>{10, 19});
  CHECK(over.advance());
  CHECK(range(over, 30) == std::pair<Index, Index>{10, 24});
  CHECK(over.advance());
  CHECK(range(over, 30) == std::pair<Index, Index>{10, 29});
}

TEST_CASE("a denoiser that sees what follows a crop carries edits to crops before them") {
  ml::EditSpread s(plan({chain({"a", "b", "c", "d"})}, 0), 65, plan({chain({"a", "b", "X", "d"})}, 0), 65, 25);
  CHECK(range(s, 40) == std::pair<Index, Index>{20, 29});
  CHECK(s.advance());  // b reads frames 10 to 35, a frames 0 to 25; d nothing before itself
  CHECK(range(s, 40) == std::pair<Index, Index>{0, 29});
  CHECK_FALSE(s.advance());
}

TEST_CASE("a longer and a shorter motion") {
  const auto three = chain({"a", "b", "c"});
  auto longer = three;
  longer.intervals.back().end = 36;
  ml::EditSpread grown(plan({three}), 30, plan({longer}), 36);
  CHECK(range(grown, 36) == std::pair<Index, Index>{18, 35});
  ml::EditSpread shrunk(plan({longer}), 36, plan({three}), 30);
  CHECK(range(shrunk, 30) == std::pair<Index, Index>{18, 29});
  // recorded rows end before the motion does: nothing can be taken there
  ml::EditSpread unrecorded(plan({three}), 25, plan({three}), 30);
  CHECK(range(unrecorded, 30) == std::pair<Index, Index>{25, 29});
}

TEST_CASE("a limit keeps what is further away, and says so") {
  const auto before = plan({chain({"a", "b", "c", "d", "e"})}), after = plan({chain({"a", "b", "X", "d", "e"})});
  ml::EditSpread s(before, 50, after, 50, 0, 3);
  CHECK(range(s, 50) == std::pair<Index, Index>{18, 31});
  CHECK_FALSE(s.limited());
  CHECK(s.advance());
  CHECK(s.limited());
  CHECK(range(s, 50) == std::pair<Index, Index>{15, 34});
  CHECK_FALSE(s.advance());
  CHECK(crops_of(s.needed()) == std::vector<ml::FrameRange>{{8, 22}, {18, 32}, {28, 42}, {18, 22}, {28, 32}});
  ml::EditSpread wide(before, 50, after, 50, 0, 1000);
  while (wide.advance()) continue;
  CHECK_FALSE(wide.limited());
}
