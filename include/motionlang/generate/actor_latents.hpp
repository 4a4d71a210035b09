// SPDX-License-Identifier: MIT
/// ACTOR, a model of actions with one latent for every motion, as a MotionModel.
#pragma once

#include <functional>  // rows to clips

#include <motionlang/generate/latent_motion_model.hpp>
#include <motionlang/kinematics/on_smpl.hpp>
#include <motionlang/systems/actor.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// ACTOR with conversions from clips to its rows and back.
template <Backend B>
struct ActorLatents {
  using S = typename B::scalar;

  Actor<B> model;
  std::vector<std::string> labels{};  // names of the actions; none: they are numbers
  double fps = 20;
  Index longest = 60;                                     // frames of its training motions
  std::function<Motion(std::span<const S>)> motion_of{};  // on the floor
  std::function<std::vector<double>(const Motion&)> rows_of{};
};

namespace detail {

/// Normal values times a factor.
template <Scalar S>
struct ScaledNoise {
  Philox rng;
  S factor = 1;

  void normal(std::span<S> out) {
    rng.normal(out);
    for (S& x : out) x *= factor;
  }
};

/// Throws option_error 101 for a motion whose length a fully connected network cannot make.
[[noreturn]] void raise_other_length(Index frames, Index wanted, double fps);

}  // namespace detail

template <Backend B>
class ActorLatentModel final : public LatentMotionModel {
 public:
  explicit ActorLatentModel(ActorLatents<B> parts) : parts_(std::move(parts)) {}

  double fps() const override { return parts_.fps; }
  bool takes_actions() const override { return true; }

 private:
  Motion motion(const Timeline& timeline, Philox noise, const GenerateOptions& options) const override {
    const Interval& wanted = only_text(timeline);
    const Index action = class_of(wanted.text), frames = wanted.end - wanted.start;
    require_frames(frames, parts_.model.fc_decoder.has_value());
    const auto rows = motionlang::generate(parts_.model, std::span(&action, 1), std::span(&frames, 1), noise,
                                           {.fact = options.fact.value_or(1)})
                          .rows;
    return parts_.motion_of(rows.span());
  }
  std::vector<Motion> line(const Timeline& from, const Timeline& to, Index count, Philox noise,
                           double fact) const override {
    const Interval &first = only_text(from), &last = only_text(to);
    detail::ScaledNoise<typename B::scalar> scaled{noise, static_cast<typename B::scalar>(fact)};
    const auto made = interpolate_actions(parts_.model, class_of(first.text), class_of(last.text), count,
                                          first.end - first.start, scaled);
    std::vector<Motion> motions;
    for (Index i = 0; i < count; ++i) {
      const auto rows = made[i];
      motions.push_back(parts_.motion_of(rows.span()));
    }
    return motions;
  }
  Motion on_its_joints(const Motion& motion) const override { return on_smpl(motion); }
  Motion decoded(const Motion& motion, const std::string& action) const override {
    if (action.empty()) raise<option_error>(102, "ACTOR needs to know which action the motion shows to denoise it");
    const Index known = class_of(action), frames = motion.frames(),
                width = parts_.model.config.njoints * parts_.model.config.nfeats;
    require_frames(frames, parts_.model.fc_encoder || parts_.model.fc_decoder);
    const auto rows = parts_.rows_of(motion);
    const std::vector<typename B::scalar> values(rows.begin(), rows.end());
    const Sequences<B> x(Tensor<B, 2>::from(values, {frames, width}), Offsets{frames});
    const auto rows_of_latent = denoise(parts_.model, x, std::span(&known, 1)).rows;
    return parts_.motion_of(rows_of_latent.span());
  }
  Index longest() const override { return parts_.longest; }

  /// Fully connected networks have motions of one length.
  void require_frames(Index frames, bool fully_connected) const {
    const Index wanted = parts_.model.config.num_frames;
    if (fully_connected && frames != wanted) detail::raise_other_length(frames, wanted, fps());
  }
  Index class_of(const std::string& action) const {
    return action_of(action, parts_.labels, parts_.model.config.num_classes);
  }

  ActorLatents<B> parts_;
};

template <Backend B>
std::unique_ptr<MotionModel> actor_motion_model(ActorLatents<B> parts) {
  return std::make_unique<ActorLatentModel<B>>(std::move(parts));
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/actor_latents.ipp>
#endif
