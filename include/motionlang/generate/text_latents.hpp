// SPDX-License-Identifier: MIT
/// Models of texts with one latent for every motion (TEMOS, TMR, SINC) as a MotionModel.
#pragma once

#include <cmath>       // lround
#include <functional>  // texts to states

#include <motionlang/features/feature_rows.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/generate/finish_motion.hpp>
#include <motionlang/generate/latent_motion_model.hpp>
#include <motionlang/vae/text_motion.hpp>
#include <motionlang/weights/text_motion_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A model with conversions: texts and clips to its inputs, and its rows to clips.
template <Backend B, class Model>
struct TextLatents : TextMotionCheckpoint<B, Model> {
  std::function<Interval(const Timeline&)> wanted = only_text;  // the text for the model, and its frames
};
/// A motion model from the result of load_temos, load_tmr, load_teach or load_sinc.
template <Backend B, class Model>
TextLatents<B, Model> text_latents(TextMotionCheckpoint<B, Model> checkpoint) {
  return {std::move(checkpoint)};
}

template <Backend B, class Model>
class TextLatentModel final : public LatentMotionModel {
 public:
  explicit TextLatentModel(TextLatents<B, Model> parts) : parts_(std::move(parts)) {}

  double fps() const override { return parts_.fps; }
  /// A deterministic model has no random latents.
  bool draws_latents() const override {
    if constexpr (requires { parts_.model.config.vae; })
      return parts_.model.config.vae;
    else
      return true;
  }

 private:
  Motion motion(const Timeline& timeline, Philox noise, const GenerateOptions& options) const override {
    const Interval wanted = parts_.wanted(timeline);
    const auto tokens = parts_.tokens(std::span(&wanted.text, 1));
    return motion_of(text_to_motion(parts_.model, tokens, Offsets{wanted.end - wanted.start}, noise, 1,
                                    {.fact = options.fact.value_or(1)})
                         .front()
                         .rows);
  }
  std::vector<Motion> line(const Timeline& from, const Timeline& to, Index count, Philox noise,
                           double fact) const override {
    const Interval first = parts_.wanted(from);
    const std::vector<std::string> texts{first.text, parts_.wanted(to).text};
    const auto made =
        interpolate_texts(parts_.model, parts_.tokens(texts), count, first.end - first.start, noise, {.fact = fact});
    std::vector<Motion> motions;
    for (Index i = 0; i < count; ++i) motions.push_back(motion_of(made[i]));
    return motions;
  }
  Motion on_its_joints(const Motion& motion) const override { return on_joints_of(*parts_.features, motion); }
  Motion decoded(const Motion& motion, const std::string& action) const override {
    if (!action.empty()) raise<option_error>(102, "action '", action, "' is for ACTOR; this model needs no action");
    const auto rows = parts_.features->from_motion(motion);
    const std::vector<typename B::scalar> values(rows.begin(), rows.end());
    const Index width = parts_.features->width, frames = std::ssize(values) / width;
    const auto x = parts_.normalizer.normalize(Tensor<B, 2>::from(values, {frames, width}));
    const auto z = parts_.model.encode_motion(Sequences<B>(x, Offsets{frames})).mu;
    return motion_of(parts_.model.decode(z, Offsets{frames}).rows);
  }
  Index longest() const override { return std::max<Index>(2, std::lround(parts_.longest * parts_.fps)); }

  Motion motion_of(const Tensor<B, 2>& normalized) const {
    const auto rows = parts_.normalizer.denormalize(normalized);
    const std::vector<double> values(rows.span().begin(), rows.span().end());
    return motion_of_rows(*parts_.features, values, parts_.fps);
  }

  TextLatents<B, Model> parts_;
};

template <Backend B, class Model>
std::unique_ptr<MotionModel> text_motion_model(TextLatents<B, Model> parts) {
  return std::make_unique<TextLatentModel<B, Model>>(std::move(parts));
}

MOTIONLANG_NAMESPACE_END
