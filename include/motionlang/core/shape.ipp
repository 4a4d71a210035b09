// SPDX-License-Identifier: MIT
// Bodies of shape.hpp.
#pragma once

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY std::string shape_text(std::span<const Index> sizes) {
  return concat_text("(", join_text(sizes, ", ", [](Index n) { return n < 0 ? "any" : concat_text(n); }), ")");
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
