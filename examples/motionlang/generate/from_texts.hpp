// TEMOS, TMR and SINC behind the Generator: the latent of a motion comes from a text.
#pragma once

#include <cmath>
#include <functional>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/vae/text_motion.hpp>

#include "from_latent.hpp"

namespace program {

/// A model, with encode_text, encode_motion and decode, and what turns texts and clips into what it reads and its rows
/// into clips.
template <class Model>
struct TextLatents {
  using B = ml::EigenBackend<float>;

  Model model;
  ml::Normalizer<B> normalizer;
  const ml::MotionFeatures* features = nullptr;
  double fps = 0;
  std::function<ml::Sequences<B>(std::span<const std::string>)> tokens;
  double longest = 10;  // seconds that the model learned from
  std::function<ml::Interval(const ml::Timeline&)> wanted = only_text;
};

/// Those of a published model (weights/vae_run.hpp).
template <class Run>
auto text_latents(Run run) {
  using B = ml::EigenBackend<float>;
  const ml::MotionFeatures& features = published_temos_features(run.width());
  return TextLatents<decltype(run.model)>{
      .model = std::move(run.model),
      .normalizer = std::move(run.normalizer),
      .features = &features,
      .fps = run.fps,
      .tokens = [encoder = std::move(run.text_encoder)](std::span<const std::string> texts) {
        return encoder.template encode<B>(texts).tokens;
      }};
}

template <class Model>
class FromTexts final : public FromLatent {
 public:
  explicit FromTexts(TextLatents<Model> parts) : parts_(std::move(parts)) {}

  double fps() const override { return parts_.fps; }
  /// Not of a deterministic model.
  bool draws_latents() const override {
    if constexpr (requires { parts_.model.config.vae; })
      return parts_.model.config.vae;
    else
      return true;
  }

 private:
  using B = typename TextLatents<Model>::B;
  using Index = ml::Index;

  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise, const GenerationSettings& settings) const override {
    const ml::Interval wanted = parts_.wanted(timeline);
    const auto tokens = parts_.tokens(std::span(&wanted.text, 1));
    return motion_of(ml::text_to_motion(parts_.model, tokens, ml::Offsets{wanted.end - wanted.start}, noise, 1,
                                        {.fact = settings.fact.value_or(1)})
                         .front()
                         .rows);
  }
  std::vector<ml::Motion> line(const ml::Timeline& from, const ml::Timeline& to, Index count, ml::Philox noise,
                               double fact) const override {
    const ml::Interval first = parts_.wanted(from);
    const std::vector<std::string> texts{first.text, parts_.wanted(to).text};
    const auto made = ml::interpolate_texts(parts_.model, parts_.tokens(texts), count, first.end - first.start, noise,
                                            {.fact = fact});
    std::vector<ml::Motion> motions;
    for (Index i = 0; i < count; ++i) motions.push_back(motion_of(made[i]));
    return motions;
  }
  ml::Motion on_its_joints(const ml::Motion& motion) const override { return on_joints_for(*parts_.features, motion); }
  ml::Motion decoded(const ml::Motion& motion, const std::string& action) const override {
    if (!action.empty())
      ml::raise<usage_error>(102, "--action '", action, "' is for ACTOR; this model reads the motion alone");
    const std::vector<float> values = as_floats(parts_.features->from_motion(motion));
    const Index width = parts_.features->width, frames = std::ssize(values) / width;
    const auto x = parts_.normalizer.normalize(ml::Tensor<B, 2>::from(values, {frames, width}));
    const auto z = parts_.model.encode_motion(ml::Sequences<B>(x, ml::Offsets{frames})).mu;
    return motion_of(parts_.model.decode(z, ml::Offsets{frames}).rows);
  }
  Index longest() const override { return std::max<Index>(2, std::lround(parts_.longest * parts_.fps)); }

  ml::Motion motion_of(const ml::Tensor<B, 2>& normalized) const {
    return motion_of_features(*parts_.features, parts_.normalizer.denormalize(normalized).span(), parts_.fps);
  }

  TextLatents<Model> parts_;
};

template <class Model>
std::unique_ptr<Generator> from_texts(TextLatents<Model> parts) {
  return std::make_unique<FromTexts<Model>>(std::move(parts));
}

}  // namespace program
