// SPDX-License-Identifier: MIT
/// Measures TEMOS: errors of several motions of each text and of the mean of the latent, compared with motions that do
/// not depend on the text.
///
///     const auto errors = temos_errors<B>(temos.model, temos.normalizer, *temos.features, data, data.test,
///                                         {.tokens = temos.tokens, .samples = 10});
///
/// Source  TEMOS (Petrovich, Black, Varol, ECCV 2022), tables 1 and 2, temos/model/metrics/compute.py; thesis 4.3
#pragma once

#include <cstdint>     // seed
#include <functional>  // tokens
#include <span>        // rows
#include <string>      // texts
#include <vector>      // motions

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/metrics/sampled_errors.hpp>
#include <motionlang/systems/temos.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// How joints are measured. MMM's 21 joints as in TEMOS: Y up, 640 units per metre taken for millimetres, in the
/// heading of knees and elbows. SMPL's 22 joints: in metres, Z up.
struct TemosJoints {
  const MotionFeatures& features;
  bool mmm;
  RifkeVariant variant;
  double unit;  // metres

  explicit TemosJoints(const MotionFeatures& features);
  /// rows    (frames, width), not normalised
  /// result  (frames, joints)
  JointFrames operator()(std::span<const float> rows) const;
};

/// How motions are measured.
template <Backend B>
struct TemosMeasures {
  std::function<Sequences<B>(std::span<const std::string>)> tokens;  // the input of the text encoder for texts
  /// Receives each text with its mean motion and the recorded one, as rows of features.
  std::function<void(const std::string& text, std::span<const float> mean, std::span<const float> recorded)> made{};
  std::function<void(const SampledErrors&)> sampled{};  // receives the errors of the samples, at the end
  Index samples = 10;                                   // motions for each text
  std::uint64_t seed = 0;
};

/// The rows of a motion that its first text is about.
std::span<const float> first_text_rows(const DescribedMotion& motion, Index width);

/// Rows: those of named_errors(SampledErrors), "mean of the latent", and those of named_errors(BlindErrors).
/// data    with the features that the model reads; its training motions give the blind guesses
/// part    the motions to measure, each with its first text
/// Throws  cancelled
template <Backend B>
std::vector<NamedErrors> temos_errors(const Temos<B>& model, const Normalizer<B>& normalizer,
                                      const MotionFeatures& features, const DescribedMotions& data,
                                      const std::vector<DescribedMotion>& part, const TemosMeasures<B>& how,
                                      Progress progress = {}) {
  const TemosJoints joints_of(features);
  const JointErrors none(joints_of.variant, joints_of.unit);
  SampledErrors sampled(none, how.samples);
  JointErrors at_mean = none;
  BlindErrors blind(
      joints_of.variant, none, std::ssize(data.training),
      [&](Index i) { return joints_of(first_text_rows(data.training[static_cast<std::size_t>(i)], features.width)); },
      how.seed);
  const auto rng = Philox{.seed = how.seed};
  Index done = 0;
  for (const DescribedMotion& motion : part) {
    const auto recorded = first_text_rows(motion, features.width);
    const JointFrames truth = joints_of(recorded);
    const std::string& text = motion.texts.front().text;
    const auto tokens = how.tokens(std::span(&text, 1));
    const Offsets length{std::ssize(truth) / features.joints};
    const auto rows_of = [&](const Sequences<B>& s) {
      const auto values = normalizer.denormalize(s.rows).to_vector();
      return std::vector<float>(values.begin(), values.end());
    };
    std::vector<JointFrames> samples;
    for (const auto& s : text_to_motion(model, tokens, length, rng, how.samples))
      samples.push_back(joints_of(rows_of(s)));
    sampled.add(samples, truth);
    const auto mean = rows_of(text_to_motion(model, tokens, length, rng, 1, {.mean = true}).front());
    at_mean.add(joints_of(mean), truth);
    blind.add(truth);
    if (how.made) how.made(text, mean, recorded);
    progress(++done, std::ssize(part));
  }
  if (how.sampled) how.sampled(sampled);
  std::vector<NamedErrors> out = named_errors(sampled);
  out.push_back({"mean of the latent", at_mean.result()});
  for (NamedErrors& row : named_errors(blind)) out.push_back(std::move(row));
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/temos_evaluation.ipp>
#endif
