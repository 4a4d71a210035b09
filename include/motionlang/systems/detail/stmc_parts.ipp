// SPDX-License-Identifier: MIT
// Bodies of stmc_parts.hpp.
#pragma once

#include <map>      // texts that are the same
#include <numbers>  // pi

#include <motionlang/features/smplrifke.hpp>
#include <motionlang/systems/detail/stmc_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY DifferentTexts::DifferentTexts(const BatchPlan& plan) {
  std::map<std::string_view, Index> known{{"", 0}};
  for (const TimelinePlan& p : plan.timelines) {
    for (const Interval& i : p.timeline.intervals) {
      const auto [place, is_new] = known.emplace(i.text, std::ssize(texts));
      if (is_new) texts.push_back(i.text);
      which.push_back(place->second);
    }
  }
}

MOTIONLANG_BODY void require_own_motions(BatchMates mates, bool one_token) {
  if (mates == BatchMates::none || (mates == BatchMates::longest_text && one_token)) return;
  raise<option_error>(102,
                      "a motion of this model depends on the other timelines of its list, so that several processes "
                      "cannot share the list");
}

MOTIONLANG_BODY Motion published_motion(std::span<const double> features, double fps) {
  return smplrifke_to_motion<double>(features, {.first_angle = std::numbers::pi}, fps);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
