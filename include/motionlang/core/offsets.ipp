// SPDX-License-Identifier: MIT
// Bodies of offsets.hpp.
#pragma once

#include <motionlang/core/offsets.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY Offsets Offsets::equal(Index count, Index length) {
  if (count < 0) raise<shape_error>(207, "Offsets: ", count, " sequences");
  return Offsets(std::span<const Index>(PoolVector<Index>(static_cast<std::size_t>(count), length)));
}

MOTIONLANG_BODY Index Offsets::longest() const {
  Index n = 0;
  for (Index i = 0; i < count(); ++i) n = length(i) > n ? length(i) : n;
  return n;
}

MOTIONLANG_NAMESPACE_END
