// Texts cut where what they own changes.
#include <doctest/doctest.h>

#include <motionlang/compose/handovers.hpp>
#include <motionlang/compose/plan.hpp>
#include <motionlang/compose/timeline_text.hpp>

namespace ml = motionlang;

namespace {

ml::Timeline parsed(const char* text) { return ml::parse_timeline(text, {.fps = 1}); }

}  // namespace

TEST_CASE("a text that lends its arms is cut where they go and where they come back") {
  const auto timeline = parsed(
      "walk # 0 # 120 # legs\n"
      "raise both arms # 40 # 100 # left arm # right arm\n"
      "nod # 60 # 70 # head\n");
  const auto cut = ml::cut_at_handovers(timeline, 10);
  CHECK(cut == parsed("walk # 0 # 40 # legs\n"
                      "walk # 40 # 60 # legs\n"
                      "walk # 60 # 70 # legs\n"
                      "walk # 70 # 100 # legs\n"
                      "walk # 100 # 120 # legs\n"
                      "raise both arms # 40 # 100 # left arm # right arm\n"
                      "nod # 60 # 70 # head\n"));
  // Every part belongs to the same text at every time.
  const auto before = ml::plan_timeline(timeline), after = ml::plan_timeline(cut);
  REQUIRE(before.pieces.size() == after.pieces.size());
  for (std::size_t k = 0; k < before.pieces.size(); ++k) {
    for (std::size_t p = 0; p < ml::body_part_count; ++p) {
      auto text = [&](const ml::TimelinePlan& plan) {
        return plan.timeline.intervals[static_cast<std::size_t>(plan.owners[k][p])].text;
      };
      CHECK(text(before) == text(after));
    }
  }
}

TEST_CASE("stretches that would be too short stay with their neighbour; texts that follow each other stay whole") {
  CHECK(ml::cut_at_handovers(parsed("walk # 0 # 60 # legs\nwave # 5 # 52 # right arm\n"), 10) ==
        parsed("walk # 0 # 60 # legs\nwave # 5 # 52 # right arm\n"));
  CHECK(ml::cut_at_handovers(parsed("walk # 0 # 60 # legs\nwave # 5 # 50 # right arm\n"), 10) ==
        parsed("walk # 0 # 50 # legs\nwalk # 50 # 60 # legs\nwave # 5 # 50 # right arm\n"));
  const auto one_after_the_other = parsed("walk # 0 # 30 # legs\nsit down # 30 # 60 # legs\n");
  CHECK(ml::cut_at_handovers(one_after_the_other, 1) == one_after_the_other);
  CHECK(ml::cut_at_handovers(ml::Timeline{}, 1) == ml::Timeline{});
}
