// SPDX-License-Identifier: MIT
/// The error for a mistake in a caller's options.
#pragma once

#include <motionlang/core/error.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A config_error that the caller caused, not a file. Examples are options that a model or a file does not take,
/// options that contradict each other, and a result that would overwrite its source.
struct option_error : config_error {
  using config_error::config_error;
};

MOTIONLANG_NAMESPACE_END
