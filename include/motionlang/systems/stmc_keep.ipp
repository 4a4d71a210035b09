// SPDX-License-Identifier: MIT
// Bodies of stmc_keep.hpp.
#pragma once

#include <motionlang/systems/stmc_keep.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::vector<Index> positions_of(const FeatureLayout& layout, BodyParts parts) {
  std::vector<Index> out;
  for (int p = 0; p < layout.body.size(); ++p) {
    if (!parts.has(static_cast<BodyPart>(p))) continue;
    const std::vector<Index> own = layout.indices(static_cast<BodyPart>(p));
    out.insert(out.end(), own.begin(), own.end());
  }
  return out;
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
