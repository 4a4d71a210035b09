// Timelines and layouts as golden cases give them. Used by all functions that compose.
#pragma once

#include <motionlang/compose/plan.hpp>
#include <motionlang/core/python_random.hpp>
#include <motionlang/features/layout.hpp>

#include "golden.hpp"
#include "seeds.hpp"

namespace golden {

/// in/timeline_ptr, in/intervals, in/parts. The texts are not in the file: "0", "1", ... in order.
inline std::vector<ml::Timeline> timelines_of(const Case& c) {
  const auto ptr = c.values<ml::Index>("in/timeline_ptr"), times = c.values<ml::Index>("in/intervals");
  const auto parts = c.values<std::uint8_t>("in/parts");
  std::vector<ml::Timeline> out(ptr.size() - 1);
  for (std::size_t m = 0; m + 1 < ptr.size(); ++m) {
    for (auto i = static_cast<std::size_t>(ptr[m]); i < static_cast<std::size_t>(ptr[m + 1]); ++i) {
      ml::Interval interval{std::to_string(i), times.at(2 * i), times.at(2 * i + 1), {}};
      for (std::size_t p = 0; p < ml::body_part_count; ++p) {
        if (parts.at(5 * i + p) != 0) interval.parts = interval.parts.with(static_cast<ml::BodyPart>(p));
      }
      out[m].intervals.push_back(interval);
    }
  }
  return out;
}

/// As published (gaps and hidden texts are errors), with the options of the case.
inline ml::PlanOptions plan_options(const Case& c) {
  return {.overlap = c.config().value_or("overlap_frames", ml::Index{10}),
          .extend = c.config().value_or("extend", true),
          .transition_crops = c.config().value_or("transition_crops", true),
          .gaps = ml::Gaps::refuse};
}

/// Equal texts as the case wants them: the first one, or as CPython shuffles them (one generator for all timelines).
inline ml::BatchPlan planned(const Case& c, const std::vector<ml::Timeline>& timelines,
                             const ml::PlanOptions& options) {
  if (c.config().value_or("ties", "lowest") != "cpython_random") return ml::plan_timelines(timelines, options);
  auto random = seeded<ml::PythonRandom>(c.config()["seed"]);
  return ml::plan_timelines(timelines, options, random);
}

inline ml::FeatureLayout layout_of(const Case& c) {
  const auto name = c.config()["layout"].as<std::string>();
  if (name == "smplrifke") return ml::smplrifke_layout();
  if (name == "guoh3dfeats") return ml::guoh3dfeats_layout();
  ml::raise<ml::config_error>(103, "unknown layout '", name, "'");
}

}  // namespace golden
