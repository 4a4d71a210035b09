// SPDX-License-Identifier: MIT
// Bodies of judgement_report.hpp.
#pragma once

#include <filesystem>  // the folder of pictures

#include <motionlang/core/formatted.hpp>
#include <motionlang/core/quantile.hpp>
#include <motionlang/file/png.hpp>
#include <motionlang/generate/judgement_report.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/weights/metadata_number.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline double percent_of(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}
inline std::string shares_line(double hovering, double sinking, double statues) {
  return formatted("hovering %.1f %%, sinking %.1f %%, statues %.1f %%\n", 100 * hovering, 100 * sinking,
                   100 * statues);
}

}  // namespace detail

MOTIONLANG_BODY std::string describe_judgement(const Judgement& j, bool details) {
  std::string out = formatted("%-44s %-8s %s\n", "prompt", "done", "what counts");
  for (std::size_t i = 0; i < j.prompts.size(); ++i) {
    out += formatted("%-44s %zu/%-6zu %s\n", j.prompts[i].name().c_str(), j.done(i), j.verdicts[i].size(),
                     j.prompts[i].rule().c_str());
    for (std::size_t seed = 0; details && seed < j.verdicts[i].size(); ++seed) {
      const Verdict& v = j.verdicts[i][seed];
      out += formatted("    seed %zu: %s (ahead %.2f m/s, air %.2f s, turned %.0f)\n", seed,
                       v.why_not.empty() ? "done" : v.why_not.c_str(), v.speed, v.air, v.turned);
    }
  }
  out +=
      formatted("%-44s %zu/%zu = %.0f %%\n", "all", j.done(), j.motions(), detail::percent_of(j.done(), j.motions()));
  out += formatted("foot skate %.3f m/s, jitter %.1f m/s^3 (means over all motions)\n", j.skate, j.jitter);
  return out + detail::shares_line(j.hovering(), j.sinking(), j.statues());
}

MOTIONLANG_BODY std::string judgement_header() {
  return "| prompts | length | done | hovering / sinking / statues | foot skate m/s | jitter m/s^3 |\n"
         "|---|---|---|---|---|---|\n";
}
MOTIONLANG_BODY std::string judgement_row(const Judgement& j, const std::string& about, double seconds) {
  const std::string length = seconds > 0 ? concat_text(static_cast<int>(seconds), " s") : "own";
  return formatted("| %s | %s | %.0f %% | %.1f / %.1f / %.1f %% | %.3f | %.0f |\n", about.c_str(), length.c_str(),
                   detail::percent_of(j.done(), j.motions()), 100 * j.hovering(), 100 * j.sinking(), 100 * j.statues(),
                   j.skate, j.jitter);
}

MOTIONLANG_BODY std::string describe_recordings(const RecordedFigures& f, bool details) {
  std::string out =
      formatted("recordings: %zu segments on the floor, %zu elsewhere left out\n", f.segments, f.elsewhere) +
      detail::shares_line(f.hovering, f.sinking, f.statues) +
      formatted("%-36s %8s %8s %8s %8s %8s\n", "", "median", "90 %", "95 %", "99 %", "largest");
  for (const RecordedMeasure& m : f.measures) {
    out += formatted("%-36s", m.name.c_str());
    for (const double share : {0.5, 0.9, 0.95, 0.99, 1.0}) out += formatted(" %8.3f", quantile(m.values, share));
    out += "\n";
  }
  out += formatted("%-24s %-10s %-24s %-24s %s\n", "caption says", "done", "ahead m/s, 5 50 95 %", "air s",
                   "turned, degrees");
  for (const RecordedVerb& v : f.verbs) {
    if (v.segments == 0) continue;
    out += formatted("%-24s %3zu/%-6zu", v.name.c_str(), v.done, v.segments);
    for (const auto* values : {&v.speed, &v.air, &v.turned})
      out +=
          formatted("  %6.2f %6.2f %6.2f  ", quantile(*values, 0.05), quantile(*values, 0.5), quantile(*values, 0.95));
    out += "\n";
    for (std::size_t i = 0; details && i < v.why_not.size(); ++i) out += "    " + v.why_not[i] + "\n";
  }
  return out;
}

MOTIONLANG_BODY std::string recordings_line(const std::map<std::string, std::string>& metadata,
                                            const std::string& name) {
  const auto value = [&](const char* entry) { return detail::metadata_number<double>(metadata, entry, name); };
  if (!metadata.contains("real.skate") || !metadata.contains("real.jitter")) return "";
  return formatted("recordings: foot skate %.3f m/s, jitter %.1f m/s^3\n", value("real.skate"), value("real.jitter"));
}

MOTIONLANG_BODY std::string steps_cost_header() {
  return "| sampler | steps | prompts done | foot skate m/s | jitter m/s^3 | bone lengths +- % | joints, mm away | "
         "processor s per s of motion |\n|---|---|---|---|---|---|---|---|\n";
}
MOTIONLANG_BODY std::string steps_cost_row(const std::string& sampler, const StepsCost& c) {
  return formatted("| %s | %td | %.0f %% | %.3f | %.1f | %.1f | %.0f | %.2f |\n", sampler.c_str(), c.steps,
                   100 * c.done, c.skate, c.jitter, 100 * c.bones, 1000 * c.away, c.seconds);
}

MOTIONLANG_BODY void write_judged_strips(const FilePath& folder, const std::string& name, const Judgement& j) {
  std::filesystem::create_directories(folder.string());
  for (std::size_t i = 0; i < j.made.size(); ++i) {
    const std::size_t prompt = i % j.prompts.size(), seed = i / j.prompts.size();
    const std::string& why = j.verdicts[prompt][seed].why_not;
    const std::string title = j.prompts[prompt].name() + ": " + (why.empty() ? "done" : why);
    write_png(folder.inside(concat_text(name, "_", prompt, "_", seed, ".png")),
              film_strip_picture(j.made[i], {}, {.width = 1000, .title = title, .resolution = 1}));
  }
}

MOTIONLANG_NAMESPACE_END
