// SPDX-License-Identifier: MIT
// Bodies of filtered_negatives.hpp.
#pragma once

#include <motionlang/core/formatted.hpp>
#include <motionlang/train/filtered_negatives.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::string filtered_negatives_table(const FilteredShares& shares) {
  std::string out = "negatives that training leaves out, %\n  threshold        ";
  for (const double t : shares.thresholds) out += formatted("%8.2f", t);
  out += formatted("\n  batches of %-6td", shares.batch);
  for (const double share : shares.by_threshold) out += formatted("%8.2f", share);
  out += "\n  batch            ";
  for (const Index b : shares.batches) out += formatted("%8td", b);
  out += formatted("\n  threshold %-7g", shares.threshold);
  for (const double share : shares.by_batch) out += formatted("%8.2f", share);
  return out + "\n";
}

MOTIONLANG_NAMESPACE_END
