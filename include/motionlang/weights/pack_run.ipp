// SPDX-License-Identifier: MIT
// Bodies of pack_run.hpp.
#pragma once

#include <motionlang/weights/pack_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY bool is_of_a_model(const std::string& name) {
  return !begins_with_any(name, {"rotation2xyz.", "rot2xyz.", "clip_model.", "_losses.", "losses.", "metrics.",
                                 "eval_model.", "opt_", "motion_normalizer."});
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END
