// SPDX-License-Identifier: MIT
// Bodies of mdm_action_run.hpp.
#pragma once

#include <motionlang/weights/mdm_action_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline bool is_unconstrained_mdm(const RunFolder& run) {
  const FileValue *now = run.option("unconstrained"), *before = run.option("cond_mode");
  return now != nullptr ? to_string(*now) == "true" : before != nullptr && to_string(*before) == "no_cond";
}

MOTIONLANG_BODY DiffusionRun mdm_action_sizes(const RunFolder& run, const TensorSet& weights, const RunReader& r) {
  DiffusionRun about;
  about.system = "mdm";
  read_mdm(about, r);
  MdmConfig& c = about.mdm;
  if (const Index wanted = 25 * size(mdm_action_features.rotations); c.nfeats != wanted)
    raise<io_error>(404, weights.name(), ": motions of ", counted(c.nfeats, "number"),
                    " a frame; models of actions have ", wanted);
  const bool unconstrained = c.condition == MdmCondition::none;
  if (c.condition == MdmCondition::text || unconstrained != is_unconstrained_mdm(run))
    raise<io_error>(404, weights.name(), ": not a model of actions");
  if (unconstrained) c.num_actions = 1;
  c.crop_frames = r.number({"num_frames"}, 60, 10'000);
  return about;
}

MOTIONLANG_BODY std::vector<std::string> mdm_action_labels(const RunFolder& run, const RunReader& r, Index actions) {
  std::vector<std::string> out;
  for (Index i = 0; i < actions; ++i) {
    const FileValue* label = run.option("labels/" + std::to_string(i));
    if (label == nullptr) return action_labels(r.text("dataset", ""), actions);
    out.push_back(to_string(*label));
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY bool is_mdm_action_run(const RunFolder& run) {
  return run.system == "mdm" && !run.weights.empty() &&
         (detail::is_unconstrained_mdm(run) ||
          detail::prefix_of(detail::run_weights(run), "embed_action.action_embedding").has_value());
}

MOTIONLANG_NAMESPACE_END
