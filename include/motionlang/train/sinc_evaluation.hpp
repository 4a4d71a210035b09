// SPDX-License-Identifier: MIT
/// Evaluates SINC on labels of BABEL: errors of several motions of each sentence, of the mean of the latent, and of
/// single labels composed by their body parts. Motions that ignore the label are printed beside them.
///
///     const auto sinc = load_sinc<B>("sinc-run");
///     const SincMeasures<B> how{.joints = joints, .sentences = sentences, .samples = 10};
///     for (const NamedErrors& row : sinc_errors(sinc, items, how)) use(row.name, row.errors);
///
/// Source  SINC (Athanasiou et al., ICCV 2023), tables 2 to 4; thesis B.3
#pragma once

#include <cstdint>     // seed
#include <functional>  // what was made
#include <string>      // sentences
#include <vector>      // motions

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/body_part_table.hpp>
#include <motionlang/datasets/label_sentences.hpp>
#include <motionlang/train/compared_joints.hpp>
#include <motionlang/train/measured_items.hpp>
#include <motionlang/train/motion_likeness.hpp>
#include <motionlang/weights/sinc_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The way in which motions are measured. Objects behind pointers must outlive the measurement.
template <Backend B>
struct SincMeasures {
  const ComparedJoints<B>& joints;
  const LabelSentences& sentences;
  const BodyPartTable* parts = nullptr;   // of single labels, whose motions are composed; null: not composed
  MotionLikeness<B>* likeness = nullptr;  // receives the first motion of each item and the composed one; null: none
  /// Receives the mean motion of each item and its sentence.
  std::function<void(const std::string& sentence, const SmplVelpMotion<typename B::scalar>& mean,
                     const DescribedMotion& recorded)>
      made{};
  Index samples = 10;  // motions of each item
  std::uint64_t seed = 0;
};

/// Rows: those of named_errors(SampledErrors), "mean of the latent", with `parts` "labels alone, composed", and those
/// of named_errors(BlindErrors).
/// items   with one or two labels each; chosen
/// Throws  cancelled; config_error 103 for a label without parts or a sentence without words
template <Backend B>
std::vector<NamedErrors> sinc_errors(const SincCheckpoint<B>& model, const MeasuredItems& items,
                                     const SincMeasures<B>& how, Progress progress = {}) {
  const auto recorded = [](const DescribedMotion& m) { return smplvelp_inverse(std::span<const float>(m.rows)); };
  const auto& training = items.data().training;
  const JointErrors none(sinc_rifke());
  SampledErrors sampled(none, how.samples);
  JointErrors at_mean = none, composed = none;
  BlindErrors blind(
      sinc_rifke(), none, std::ssize(training),
      [&](Index i) { return how.joints(recorded(training[static_cast<std::size_t>(i)])); }, how.seed);
  const auto rng = Philox{.seed = how.seed};
  Index done = 0;
  for (const Index i : items.measured()) {
    const DescribedMotion& item = items[i];
    const auto labels = labels_of(item);
    const JointFrames truth = how.joints(recorded(item));
    const Offsets length{std::ssize(item.rows) / items.data().width};
    const auto made = [&](const std::vector<std::string>& of, const Philox& noise, Index count,
                          const LatentSampling& sampling, bool alone = false) {
      std::vector<Tensor<B, 2>> out;
      const auto texts = sinc_texts<B>(
          model.model.config.mode, std::span(&of, 1),
          [&](const std::vector<std::string>& some) { return alone ? some.front() : how.sentences(some); },
          [&](const std::vector<std::string>& some) { return model.tokens(some); });
      for (const auto& s : labels_to_motion(model.model, texts, length, noise, count, sampling)) out.push_back(s.rows);
      return out;
    };
    const std::string sentence = how.sentences(labels);
    std::vector<JointFrames> samples;
    for (const auto& rows : made(labels, rng, how.samples, {})) {
      const auto motion = sinc_motion(model.normalizer, rows);
      if (how.likeness != nullptr && samples.empty()) how.likeness->add(motion, item.rows);
      samples.push_back(how.joints(motion));
    }
    sampled.add(samples, truth);
    const auto mean = sinc_motion(model.normalizer, made(labels, rng, 1, {.mean = true}).front());
    at_mean.add(how.joints(mean), truth);
    if (how.made) how.made(sentence, mean, item);
    if (how.parts != nullptr && labels.size() == 2) {
      const auto single = [&](std::size_t label) {
        const auto noise = rng.split("alone").split(static_cast<std::uint64_t>(label));
        return made({labels[label]}, noise, 1, {}, /*alone=*/true).front();
      };
      const auto motion = sinc_composed(model.normalizer, single(0), how.parts->parts(labels[0]), single(1),
                                        how.parts->parts(labels[1]));
      if (how.likeness != nullptr) how.likeness->add_composed(motion);
      composed.add(how.joints(motion), truth);
    }
    blind.add(truth, items.number_in_training(i));
    progress(++done, std::ssize(items.measured()));
  }
  std::vector<NamedErrors> out = named_errors(sampled);
  out.push_back({"mean of the latent", at_mean.result()});
  if (composed.clips() > 0) out.push_back({"labels alone, composed", composed.result()});
  for (NamedErrors& row : named_errors(blind)) out.push_back(std::move(row));
  return out;
}

MOTIONLANG_NAMESPACE_END
