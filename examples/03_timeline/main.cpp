// Reads a timeline of texts, shows when each text moves which part of the body, and shows the error for a mistake.
#include <cstdio>

#include <motionlang/compose/plan.hpp>
#include <motionlang/compose/timeline_text.hpp>

namespace ml = motionlang;

int main() {
  constexpr double fps = 20;
  const auto timeline = ml::parse_timeline(
      "walk forward     # 0.0 # 6.0 # legs\n"
      "raise both arms  # 2.0 # 5.0 # left arm # right arm\n",
      {.fps = fps});
  const auto plan = ml::plan_timeline(timeline, {.overlap = 10});
  std::printf("%td frames\n", plan.frames);
  for (const auto& owned : plan.merged) {  // every part of the body, its times, and its text
    const auto& text = plan.timeline.intervals[static_cast<std::size_t>(owned.owner)].text;
    std::printf("%-10s %3td to %3td  %s\n", ml::to_string(owned.part).c_str(), owned.range.start, owned.range.end,
                text.c_str());
  }
  for (const auto& crop : plan.crops) {  // what the denoiser reads: texts, extended by the overlap, and transitions
    std::printf("crop %3td to %3td  %s\n", crop.range.start, crop.range.end,
                crop.is_transition() ? "(transition)" : std::string(plan.text(crop)).c_str());
  }
  try {
    ml::parse_timeline("walk forward # 0.0 # 6.0 # tail\n", {.fps = fps, .name = "mistake.txt"});
  } catch (const ml::timeline_error& e) {
    std::printf("%s\n", e.what());
  }
}
