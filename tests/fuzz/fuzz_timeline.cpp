// Timelines: any text is read or refused with a timeline_error; what was read survives writing, and its plan adds every
// frame of every body part exactly once.
#include <cstdint>

#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/body_part_lexicon.hpp>
#include <motionlang/compose/plan.hpp>
#include <motionlang/compose/timeline_text.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

void check_slices(const ml::TimelinePlan& plan, const std::vector<ml::Slice>& slices) {
  for (const ml::Slice& s : slices) {
    const ml::Index length = plan.crops[static_cast<std::size_t>(s.crop)].range.size();
    check(s.from.size() == s.to.size() && s.from.size() >= 0, "a slice keeps its length");
    check(s.from.start >= 0 && s.from.end <= length, "a slice lies inside its crop");
    check(s.to.start >= 0 && s.to.end <= plan.frames, "a slice lies inside the motion");
  }
}

void check_plan(const ml::Timeline& timeline, const ml::PlanOptions& options) {
  const ml::TimelinePlan plan = ml::plan_timeline(timeline, options);
  const ml::NetWeights net = ml::net_weights(plan);
  check(net.smallest == 1 && net.largest == 1, "net weights are 1");
  check_slices(plan, plan.add);
  check_slices(plan, plan.subtract);
}

/// Writing and reading gives the same, up to texts that begin with a byte order mark.
void check_round_trip(const std::vector<ml::TimelineInSeconds>& timelines, const ml::TimelineTextOptions& options) {
  for (const auto& t : timelines) {
    for (const auto& i : t.intervals) {
      if (i.text.starts_with("\xEF\xBB\xBF")) return;
    }
  }
  check(ml::parse_timelines_in_seconds(ml::write_timelines(timelines), options) == timelines, "round trip");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  ml::is_text_list(text);
  refusing<ml::timeline_error>([&] { ml::parse_text_list(text); });
  refusing<ml::timeline_error>([&] {
    const ml::TimelineTextOptions options{.as_published = true};
    const auto timelines = ml::parse_timelines_in_seconds(text, options);
    check_round_trip(timelines, options);
    for (const auto& t : timelines) {
      ml::write_timeline(ml::single_track(t));
      ml::write_timeline(ml::one_text(t));
    }
  });
  refusing<ml::timeline_error>([&] {
    for (ml::Timeline t : ml::parse_timelines(text)) {
      check(ml::to_frames(ml::to_seconds(t, 20), 20) == t, "frames to seconds and back");
      ml::guess_missing_parts(t);
      check_plan(t, {.overlap = 11, .hidden = ml::HiddenTexts::ignore});
      check_plan(t, {.overlap = 0, .hidden = ml::HiddenTexts::ignore});
      check_plan(t, {.extend = false, .transition_crops = false, .hidden = ml::HiddenTexts::ignore});
      refusing<ml::timeline_error>([&] { check_plan(t, {.gaps = ml::Gaps::refuse}); });
    }
  });
  return 0;
}
