// SPDX-License-Identifier: MIT
/// Options that a caller cannot have meant.
#pragma once

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Options that a model or a file does not take, or that contradict each other; a result that would take the place of
/// what it is made from: a config_error that is the caller's, not the file's.
struct option_error : config_error {
  using config_error::config_error;
};

MOTIONLANG_NAMESPACE_END
