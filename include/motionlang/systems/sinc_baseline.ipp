// SPDX-License-Identifier: MIT
// Bodies of sinc_baseline.hpp.
#pragma once

#include <motionlang/systems/sinc_baseline.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<Index> crop_lengths(const BatchPlan& plan) {
  std::vector<Index> lengths;
  for (const TimelinePlan& p : plan.timelines) {
    for (const Crop& c : p.crops) lengths.push_back(c.range.size());
  }
  return lengths;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
