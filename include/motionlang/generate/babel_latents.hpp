// SPDX-License-Identifier: MIT
/// TEACH and SINC, which learned from BABEL, as a MotionModel: TEACH for texts in sequence, SINC for texts at the same
/// time.
#pragma once

#include <motionlang/generate/text_latents.hpp>
#include <motionlang/systems/sinc.hpp>
#include <motionlang/systems/teach.hpp>

MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
using TeachLatents = TextLatents<B, Teach<B>>;
template <Backend B>
using SincLatents = TextLatents<B, Sinc<B>>;

namespace detail {

/// Texts sorted by their start. Throws timeline_error 509 for texts that overlap.
std::vector<Interval> texts_in_order(const Timeline& timeline);
/// Joins all texts, which run at the same time, to one sentence.
Interval texts_together(const Timeline& timeline);
std::vector<std::string> texts_of(const Timeline& timeline);

}  // namespace detail

template <Backend B>
class TeachMotionModel final : public SeparateMotionModel {
 public:
  explicit TeachMotionModel(TeachLatents<B> parts) : parts_(std::move(parts)) {}

  double fps() const override { return parts_.fps; }
  std::string system() const override { return "TEACH"; }
  bool draws_latents() const override { return true; }

 private:
  Motion motion(const Timeline& timeline, Philox noise, const GenerateOptions& options) const override {
    std::vector<std::string> texts;
    std::vector<Index> lengths;
    for (const Interval& i : detail::texts_in_order(timeline)) {
      texts.push_back(i.text);
      lengths.push_back(i.end - i.start);
    }
    const auto states = parts_.tokens(texts);
    const auto parts = actions_to_motion(parts_.model, states, Offsets(lengths), noise, teach_window,
                                         {.fact = options.fact.value_or(1)});
    return motion_of_smplvelp(teach_motion(parts_.normalizer, parts, teach_window), parts_.fps);
  }

  TeachLatents<B> parts_;
};

template <Backend B>
std::unique_ptr<MotionModel> teach_motion_model(TeachLatents<B> parts) {
  return std::make_unique<TeachMotionModel<B>>(std::move(parts));
}
/// SINC that reads labels apart: "SINC-STE", and the ablation with a latent for each label.
template <Backend B>
class SeparateSincMotionModel final : public SeparateMotionModel {
 public:
  explicit SeparateSincMotionModel(SincLatents<B> parts) : parts_(std::move(parts)) {}

  double fps() const override { return parts_.fps; }
  std::string system() const override { return "SINC of separate texts"; }
  bool draws_latents() const override { return true; }

 private:
  Motion motion(const Timeline& timeline, Philox noise, const GenerateOptions& options) const override {
    const auto labels = detail::texts_of(timeline);
    const SincTexts<B> texts{parts_.tokens(labels), std::vector<Index>(labels.size(), 0)};
    const auto made =
        labels_to_motion(parts_.model, texts, Offsets{timeline.end()}, noise, 1, {.fact = options.fact.value_or(1)});
    return motion_of_smplvelp(sinc_motion(parts_.normalizer, made.front().rows), parts_.fps);
  }

  SincLatents<B> parts_;
};

template <Backend B>
std::unique_ptr<MotionModel> sinc_motion_model(SincLatents<B> parts) {
  if (parts.model.config.mode != SincMode::single)
    return std::make_unique<SeparateSincMotionModel<B>>(std::move(parts));
  parts.wanted = detail::texts_together;
  return text_motion_model(std::move(parts));
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/babel_latents.ipp>
#endif
