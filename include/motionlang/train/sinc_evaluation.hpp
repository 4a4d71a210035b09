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
#include <utility>     // move
#include <vector>      // motions

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/body_part_table.hpp>
#include <motionlang/datasets/label_sentences.hpp>
#include <motionlang/train/compared_joints.hpp>
#include <motionlang/train/measured_items.hpp>
#include <motionlang/train/motion_likeness.hpp>
#include <motionlang/train/shared_errors.hpp>
#include <motionlang/train/shared_items.hpp>
#include <motionlang/weights/sinc_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The way in which motions are measured. Objects behind pointers must outlive the measurement.
template <Backend B>
struct SincMeasures {
  const ComparedJoints<B>& joints;
  const LabelSentences& sentences;
  const BodyPartTable* parts = nullptr;   // of single labels, whose motions are composed; null: not composed
  MotionLikeness<B>* likeness = nullptr;  // receives the first motion of each item and the composed one; null: none
  /// Receives the mean motion of each item that is shown and its sentence: at the end, in the order of the items, in
  /// every process.
  std::function<void(const std::string& sentence, const SmplVelpMotion<typename B::scalar>& mean,
                     const DescribedMotion& recorded)>
      made{};
  ShownTexts shows{};  // the sentences for `made`; empty: all
  Index samples = 10;  // motions of each item
  std::uint64_t seed = 0;
  AnyCommunicator communicator{};  // processes that share the items; all get the errors of all
};

/// Rows: those of named_errors(SampledErrors), "mean of the latent", with `parts` "labels alone, composed", and those
/// of named_errors(BlindErrors).
/// items   with one or two labels each; chosen
/// Throws  cancelled; config_error 103 for a label without parts or a sentence without words
template <Backend B>
std::vector<NamedErrors> sinc_errors(const SincCheckpoint<B>& model, const MeasuredItems& items,
                                     const SincMeasures<B>& how, Progress progress = {}) {
  using S = typename B::scalar;
  const auto recorded = [](const DescribedMotion& m) { return smplvelp_inverse(std::span<const float>(m.rows)); };
  const auto& training = items.data().training;
  const JointErrors none(sinc_rifke());
  SampledErrors sampled(none, how.samples);
  JointErrors at_mean = none, composed = none;
  BlindErrors blind(
      sinc_rifke(), none, std::ssize(training),
      [&](Index i) { return how.joints(recorded(training[static_cast<std::size_t>(i)])); }, how.seed);
  const auto rng = Philox{.seed = how.seed};
  const auto chosen = items.chosen();
  const auto item_of = [&](Index k) -> const DescribedMotion& { return *chosen[static_cast<std::size_t>(k)]; };
  const auto sentence_of = [&](Index k) { return how.sentences(labels_of(item_of(k))); };
  const bool alone = how.communicator.size() == 1;
  const auto shown = shown_items(how.made != nullptr, std::ssize(chosen), how.shows, sentence_of);
  const auto message_of = [&](Index k, const Progress&) {
    const DescribedMotion& item = item_of(k);
    const auto labels = labels_of(item);
    const JointFrames truth = how.joints(recorded(item));
    const Offsets length{std::ssize(item.rows) / items.data().width};
    const auto made = [&](const std::vector<std::string>& of, const Philox& noise, Index count,
                          const LatentSampling& sampling, bool single = false) {
      std::vector<Tensor<B, 2>> out;
      const auto texts = sinc_texts<B>(
          model.model.config.mode, std::span(&of, 1),
          [&](const std::vector<std::string>& some) { return single ? some.front() : how.sentences(some); },
          [&](const std::vector<std::string>& some) { return model.tokens(some); });
      for (const auto& s : labels_to_motion(model.model, texts, length, noise, count, sampling)) out.push_back(s.rows);
      return out;
    };
    MessageWriter out;
    std::vector<JointFrames> samples;
    for (const auto& rows : made(labels, rng, how.samples, {})) {
      const auto motion = sinc_motion(model.normalizer, rows);
      if (how.likeness != nullptr && samples.empty()) {
        const auto pair = how.likeness->latents(motion, item.rows);
        out.list(std::span<const S>(pair.made)), out.list(std::span<const S>(pair.recorded));
      }
      samples.push_back(how.joints(motion));
    }
    put_clips(out, sampled.clips(samples, truth));
    const auto mean = sinc_motion(model.normalizer, made(labels, rng, 1, {.mean = true}).front());
    std::vector<JointErrors::Clip> others{at_mean.clip(how.joints(mean), truth)};
    std::vector<S> composed_latent;
    if (how.parts != nullptr && labels.size() == 2) {
      const auto single = [&](std::size_t label) {
        const auto noise = rng.split("alone").split(static_cast<std::uint64_t>(label));
        return made({labels[label]}, noise, 1, {}, /*single=*/true).front();
      };
      const auto motion = sinc_composed(model.normalizer, single(0), how.parts->parts(labels[0]), single(1),
                                        how.parts->parts(labels[1]));
      if (how.likeness != nullptr) composed_latent = how.likeness->latent(motion);
      others.push_back(composed.clip(how.joints(motion), truth));
    }
    put_clips(out, others);
    if (!composed_latent.empty()) out.list(std::span<const S>(composed_latent));
    if (shown[static_cast<std::size_t>(k)]) put_smplvelp(out, mean);
    if (alone) blind.add(truth, items.number_in_training(k));
    return out.bytes();
  };
  Index next = 0;
  for (const std::string& message : shared_items(how.communicator, std::ssize(chosen), message_of, progress)) {
    const Index k = next++;
    MessageReader in(message);
    if (how.likeness != nullptr) {
      auto made = in.list<S>();
      how.likeness->add({std::move(made), in.list<S>()});
    }
    sampled.add(take_clips(in));
    const auto others = take_clips(in);
    at_mean.add(others.front());
    if (others.size() > 1) {
      composed.add(others.back());
      if (how.likeness != nullptr) how.likeness->add_composed(in.list<S>());
    }
    if (shown[static_cast<std::size_t>(k)]) how.made(sentence_of(k), take_smplvelp<S>(in), item_of(k));
    if (!alone) blind.add(how.joints(recorded(item_of(k))), items.number_in_training(k));
  }
  std::vector<NamedErrors> out = named_errors(sampled);
  out.push_back({"mean of the latent", at_mean.result()});
  if (composed.clips() > 0) out.push_back({"labels alone, composed", composed.result()});
  for (NamedErrors& row : named_errors(blind)) out.push_back(std::move(row));
  return out;
}

MOTIONLANG_NAMESPACE_END
