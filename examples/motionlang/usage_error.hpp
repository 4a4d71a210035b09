// A command line that asks for what this program or this model cannot do.
#pragma once

#include <motionlang/core/error.hpp>

namespace program {

/// Exit code 2, as for a command line that cannot be read.
struct usage_error : motionlang::config_error {
  using config_error::config_error;
};

}  // namespace program
