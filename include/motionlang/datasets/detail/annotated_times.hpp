// SPDX-License-Identifier: MIT
/// The check of times in annotation files.
#pragma once

#include <cmath>        // isfinite
#include <string_view>  // place

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// Throws io_error 403, with the place in the message, unless 0 <= start <= end are times.
inline void require_times(std::string_view place, double start, double end) {
  if (!(start >= 0 && start <= end && std::isfinite(end)))
    raise<io_error>(403, place, ": from ", start, " to ", end, " seconds");
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
