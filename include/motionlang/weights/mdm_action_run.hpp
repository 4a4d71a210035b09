// SPDX-License-Identifier: MIT
/// MDM's models of actions (HumanAct12, UESTC), and of HumanAct12 without its actions (--unconstrained), from the
/// folders of their repository.
///
///     // args.json, model000750000.pt
///     const auto run = load_mdm_action_run<B>(find_run("save/humanact12/my_model"));
///     const auto motions = run.model.generate(actions, Philox{.seed = 7});
///
/// Differs   from models of texts: motions are 60 frames of 6D rotations and the path of the root, not normalised. A
///           model that was trained without empty actions (cond_mask_prob 0, as in the published command) has no
///           guidance
/// Source    MDM model/mdm.py; its training program writes args.json and model*.pt
/// Throws    as weights/diffusion_run.hpp
#pragma once

#include <motionlang/datasets/action_names.hpp>
#include <motionlang/diffusion/mdm_actions.hpp>
#include <motionlang/features/actor_points.hpp>
#include <motionlang/weights/diffusion_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
struct MdmActionRun {
  MdmActions<B> model;
  ActorFeatureOptions features{};   // the contents of a frame
  std::vector<std::string> labels;  // of the classes; empty if they are numbers; "any" for an unconstrained model
  double fps = 20;                  // of the repository's videos; the data have none
};

namespace detail {
inline constexpr ActorFeatureOptions mdm_action_features{
    .rotations = PoseRepresentation::rot6d, .translation = true, .global = true};
/// Throws io_error 404 if it is not a model of actions.
DiffusionRun mdm_action_sizes(const RunFolder& run, const TensorSet& weights, const RunReader& r);
/// Those of the options, which a training here writes, or those of the published data set; none if they are numbers.
std::vector<std::string> mdm_action_labels(const RunFolder& run, const RunReader& r, Index actions);
}  // namespace detail

/// True if a run folder is MDM's, and either of actions or unconstrained.
bool is_mdm_action_run(const RunFolder& run);

template <Backend B>
MdmActionRun<B> load_mdm_action_run(const RunFolder& run) {
  const WeightFile weights = detail::run_weights(run);
  const detail::RunReader r = detail::reader_of(run, weights);
  const DiffusionRun about = detail::mdm_action_sizes(run, weights, r);
  const MdmConfig& c = about.mdm;
  const bool unconstrained = c.condition == MdmCondition::none;
  const auto room = detail::room_of(weights);
  NoInit zeros;
  MdmActionRun<B> out{
      .model = {.denoiser = MdmDenoiser<B>(c, zeros),
                .diffusion = about.diffusion(),
                .guidance = r.real("cond_mask_prob", 0.1) == 0 ? 1.0 : 2.5},
      .features = detail::mdm_action_features,
      .labels = unconstrained ? std::vector<std::string>{"any"} : detail::mdm_action_labels(run, r, c.num_actions),
      .fps = r.real("fps", 20)};
  detail::load_denoiser(out.model.denoiser, weights, r.prefix());
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/mdm_action_run.ipp>
#endif
