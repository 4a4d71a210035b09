// SPDX-License-Identifier: MIT
/// Measures TEMOS: errors of several motions of each text and of the mean of the latent, compared with motions that do
/// not depend on the text.
///
///     const auto recorded =
///         recorded_at({.data = "KIT", .captions = "captions.tsv"}, {}, *temos.features, "test", temos_rate);
///     const auto errors = temos_errors<B>(temos.model, temos.normalizer, *temos.features, data, data.test,
///                                         {.tokens = temos.tokens, .rate = temos_rate, .recorded = recorded});
///
/// The model makes 12.5 frames per second. Its joints are interpolated linearly to 100, the rate of KIT's recordings,
/// and compared with the recorded ones at that rate.
/// Source   TEMOS (Petrovich, Black, Varol, ECCV 2022), tables 1 and 2, temos/model/metrics/compute.py; thesis 4.3.1;
///          tables 4.10 and 4.11 for the joints of SMPL
/// Differs  recordings of AMASS with 60 or 120 frames per second are resampled to the same rate; the published program
///          compares their frames, as they are, with those that it interpolated to 100 frames per second
#pragma once

#include <cstdint>     // seed
#include <filesystem>  // a body
#include <functional>  // tokens
#include <map>         // recorded motions
#include <optional>    // other joints
#include <span>        // rows
#include <string>      // texts
#include <vector>      // motions

#include <motionlang/core/progress.hpp>
#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/metrics/sampled_errors.hpp>
#include <motionlang/systems/temos.hpp>
#include <motionlang/train/compared_joints.hpp>
#include <motionlang/train/shared_errors.hpp>
#include <motionlang/train/shared_items.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The rate at which TEMOS is measured, frames per second.
inline constexpr double temos_rate = 100;

/// How joints are measured. MMM's 21 joints as in TEMOS: Y up, 640 units per metre taken for millimetres, in the
/// heading of knees and elbows. SMPL's 22 joints: in metres, Z up.
struct TemosJoints {
  const MotionFeatures& features;
  bool mmm;
  RifkeVariant variant;
  double unit;                                                    // metres
  std::function<JointFrames(std::span<const float>)> selected{};  // MMM's joints of SMPL; empty: those of the features

  explicit TemosJoints(const MotionFeatures& features);
  /// rows    (frames, width), not normalised
  /// result  (frames, joints)
  JointFrames operator()(std::span<const float> rows) const;
};

namespace detail {
/// As mmm_joints, without the joints themselves.
TemosJoints joints_as_mmm(const MotionFeatures& features, const std::string& set);
}  // namespace detail

/// MMM's joints of a model on SMPL: thesis table 4.11.
/// set     "mmm": 640 units per metre, which count as millimetres; "mmmns": metres
/// body    file of an SMPL-H body; "": the library's own skeleton
/// Throws  config_error 102 for features without SMPL's rotations, 103 for another set, and what ComparedJoints throws
template <Backend B>
TemosJoints mmm_joints(const MotionFeatures& features, const std::string& set, const std::filesystem::path& body = {}) {
  TemosJoints out = detail::joints_as_mmm(features, set);
  out.selected = [joints = ComparedJoints<B>(set, body)](std::span<const float> rows) {
    return joints(smplvelp_inverse(rows));
  };
  return out;
}

/// The rate at which motions of `fps` are measured: temos_rate, or fps if temos_rate is not a multiple of it.
double rate_of_errors(double fps);

/// Joints at another rate, by linear interpolation between frames.
/// joints  (frames, per_frame)
/// Throws  config_error 101 unless the new rate is a multiple of the old one
JointFrames joints_at_rate(const JointFrames& joints, Index per_frame, double from, double to);

/// The motions of a part at another rate. None if the data are ready-made rows, whose rate is fixed. Throws what
/// read_described_motions throws.
std::vector<DescribedMotion> recorded_at(DataSources sources, const DataConfig& config, const MotionFeatures& features,
                                         const std::string& part, double rate, Progress progress = {});

/// How motions are measured.
template <Backend B>
struct TemosMeasures {
  std::function<Sequences<B>(std::span<const std::string>)> tokens;  // the input of the text encoder for texts
  /// Receives each text that is shown with its mean motion and the recorded one, as rows of features: at the end, in
  /// the order of the list, in every process.
  std::function<void(const std::string& text, std::span<const float> mean, std::span<const float> recorded)> made{};
  ShownTexts shows{};                                   // the texts for `made`; empty: all
  std::function<void(const SampledErrors&)> sampled{};  // receives the errors of the samples, at the end
  Index samples = 10;                                   // motions for each text
  std::uint64_t seed = 0;
  std::optional<TemosJoints> joints{};  // none: those of the features
  double rate = 0;                      // frames per second of the joints that are compared; 0: that of the data
  /// The same motions at this rate, by their ids. A motion that is missing is interpolated, as generated ones are.
  std::span<const DescribedMotion> recorded{};
  /// Processes that share the motions; all get the errors of all.
  AnyCommunicator communicator{};
};

/// The rows of a motion that its first text is about.
std::span<const float> first_text_rows(const DescribedMotion& motion, Index width);
/// The rows of a motion that this text is about. Throws config_error 102 if it has no such text.
std::span<const float> rows_of_text(const DescribedMotion& motion, const std::string& text, Index width);

/// Rows: those of named_errors(SampledErrors), "mean of the latent", and those of named_errors(BlindErrors).
/// data    with the features that the model reads; its training motions give the blind guesses
/// part    the motions to measure, each with its first text
/// Throws  cancelled
template <Backend B>
std::vector<NamedErrors> temos_errors(const Temos<B>& model, const Normalizer<B>& normalizer,
                                      const MotionFeatures& features, const DescribedMotions& data,
                                      const std::vector<DescribedMotion>& part, const TemosMeasures<B>& how,
                                      Progress progress = {}) {
  const TemosJoints selected = how.joints ? *how.joints : TemosJoints(features);
  const double rate = how.rate > 0 ? how.rate : data.fps;
  const auto joints_of = [&](std::span<const float> rows) {
    return joints_at_rate(selected(rows), selected.variant.joints, data.fps, rate);
  };
  std::map<std::string, const DescribedMotion*> recorded_of;
  for (const DescribedMotion& motion : how.recorded) recorded_of.emplace(motion.id, &motion);
  const JointErrors none(selected.variant, selected.unit);
  SampledErrors sampled(none, how.samples);
  JointErrors at_mean = none;
  BlindErrors blind(
      selected.variant, none, std::ssize(data.training),
      [&](Index i) { return joints_of(first_text_rows(data.training[static_cast<std::size_t>(i)], features.width)); },
      how.seed);
  const auto rng = Philox{.seed = how.seed};
  const auto truth_of = [&](const DescribedMotion& motion) {
    const auto at_rate = recorded_of.find(motion.id);
    return at_rate == recorded_of.end()
               ? joints_of(first_text_rows(motion, features.width))
               : selected(rows_of_text(*at_rate->second, motion.texts.front().text, features.width));
  };
  const bool alone = how.communicator.size() == 1;
  const auto text_of = [&](Index i) { return part[static_cast<std::size_t>(i)].texts.front().text; };
  const auto shown = shown_items(how.made != nullptr, std::ssize(part), how.shows, text_of);
  const auto measured = [&](Index i, const Progress&) {
    const DescribedMotion& motion = part[static_cast<std::size_t>(i)];
    const auto recorded = first_text_rows(motion, features.width);
    const std::string& text = motion.texts.front().text;
    const JointFrames truth = truth_of(motion);
    const auto tokens = how.tokens(std::span(&text, 1));
    const Offsets length{std::ssize(recorded) / features.width};
    const auto rows_of = [&](const Sequences<B>& s) {
      const auto values = normalizer.denormalize(s.rows).to_vector();
      return std::vector<float>(values.begin(), values.end());
    };
    std::vector<JointFrames> samples;
    for (const auto& s : text_to_motion(model, tokens, length, rng, how.samples))
      samples.push_back(joints_of(rows_of(s)));
    auto clips = sampled.clips(samples, truth);
    const auto mean = rows_of(text_to_motion(model, tokens, length, rng, 1, {.mean = true}).front());
    clips.push_back(at_mean.clip(joints_of(mean), truth));
    if (alone) blind.add(truth);
    MessageWriter out;
    put_clips(out, clips);
    if (shown[static_cast<std::size_t>(i)]) out.list(std::span<const float>(mean));
    return out.bytes();
  };
  std::size_t next = 0;
  for (const std::string& message : shared_items(how.communicator, std::ssize(part), measured, progress)) {
    MessageReader in(message);
    const auto clips = take_clips(in);
    sampled.add(std::span(clips).first(clips.size() - 1));
    at_mean.add(clips.back());
    const DescribedMotion& motion = part[next];
    if (shown[next++]) how.made(motion.texts.front().text, in.list<float>(), first_text_rows(motion, features.width));
    if (!alone) blind.add(truth_of(motion));
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
