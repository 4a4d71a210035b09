// SPDX-License-Identifier: MIT
// Bodies of mdm_action_run.hpp.
#pragma once

#include <motionlang/weights/mdm_action_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

MOTIONLANG_BODY bool is_unconstrained_mdm(const RunFolder& run) {
  const FileValue *now = run.option("unconstrained"), *before = run.option("cond_mode");
  return now != nullptr ? to_string(*now) == "true" : before != nullptr && to_string(*before) == "no_cond";
}

}  // namespace detail

MOTIONLANG_BODY bool is_mdm_action_run(const RunFolder& run) {
  return run.system == "mdm" && !run.weights.empty() &&
         (detail::is_unconstrained_mdm(run) ||
          detail::prefix_of(detail::run_weights(run), "embed_action.action_embedding").has_value());
}

MOTIONLANG_NAMESPACE_END
