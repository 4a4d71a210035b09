// SPDX-License-Identifier: MIT
// Bodies of index.hpp.
#pragma once

#include <motionlang/tensor/index.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY void check_rows(const char* op, std::span<const Index> rows, Index n) {
  for (Index r : rows) {
    if (r < 0 || r >= n) raise<shape_error>(203, op, ": row ", r, " of ", n);
  }
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
