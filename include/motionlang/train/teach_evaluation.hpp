// SPDX-License-Identifier: MIT
/// Measures TEACH on pairs of labels of BABEL: the errors of two actions in sequence, and how far joints jump between
/// them. It compares TEACH with models that do not know the action before, and with motions that do not depend on the
/// labels.
///
///     const auto teach = load_teach<B>("teach-run");
///     const TeachMeasures<B> how{.joints = joints,
///                                .baselines = {independent_baseline<B>("sinc-run", {}, *teach.features)},
///                                .samples = 10};
///     const TeachFigures figures = teach_figures(teach, items, how);
///     use(figures.transitions.front().metres);
///
/// Source  TEACH (Athanasiou et al., 3DV 2022), tables 1 to 3; thesis A.3
#pragma once

#include <cstdint>     // seed
#include <functional>  // what was made
#include <string>      // rows of tables
#include <utility>     // move
#include <vector>      // motions

#include <motionlang/core/progress.hpp>
#include <motionlang/text/joined_labels.hpp>
#include <motionlang/train/compared_joints.hpp>
#include <motionlang/train/measured_items.hpp>
#include <motionlang/train/shared_errors.hpp>
#include <motionlang/train/shared_items.hpp>
#include <motionlang/weights/babel_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True if both actions have at least two frames, which teach_figures requires.
inline bool has_two_actions(const DescribedMotion& m) {
  return m.texts.size() == 2 && m.texts[0].frames.length > 1 && m.texts[1].frames.length > 1;
}

/// A model that does not know the action before.
template <Backend B>
struct TeachBaseline {
  std::string name;
  bool has_parts;  // two motions, which are joined; else one motion for both labels
  Normalizer<B> normalizer;
  /// The parts of one motion, normalised, as Teach::generate returns them.
  std::function<Sequences<B>(const std::vector<std::string>& labels, const Offsets& lengths, const Philox& noise,
                             Index window)>
      parts;
};

/// "independent": each action alone, joined as TEACH's actions are.
/// folder, features  as for with_babel_checkpoint, which also documents the errors
/// Source            thesis A.3.3
template <Backend B>
TeachBaseline<B> independent_baseline(const std::filesystem::path& folder, const CheckpointOptions& options,
                                      const MotionFeatures& features) {
  TeachBaseline<B> out{"independent", true, {}, {}};
  with_babel_checkpoint<B>(folder, options, features, [&](auto model) {
    out.normalizer = model.normalizer;
    out.parts = [model = std::move(model)](const std::vector<std::string>& labels, const Offsets& lengths, Philox noise,
                                           Index window) {
      const auto eps = Tensor<B, 2>::randn({std::ssize(labels), model.model.config.latent_dim}, noise);
      return independent_actions(model.model, model.tokens(labels), lengths, eps, window);
    };
  });
  return out;
}
/// "joint": one motion of the text "a, b".
template <Backend B>
TeachBaseline<B> joint_baseline(const std::filesystem::path& folder, const CheckpointOptions& options,
                                const MotionFeatures& features) {
  TeachBaseline<B> out{"joint", false, {}, {}};
  with_babel_checkpoint<B>(folder, options, features, [&](auto model) {
    out.normalizer = model.normalizer;
    out.parts = [model = std::move(model)](const std::vector<std::string>& labels, const Offsets& lengths,
                                           const Philox& noise, Index) {
      const std::string text = join_labels(labels, Conjunction::comma);
      const Offsets whole{lengths.rows()};
      return text_to_motion(model.model, model.tokens(std::span(&text, 1)), whole, noise).front();
    };
  });
  return out;
}

/// How motions are measured. Everything that it points to must outlive the measurement.
template <Backend B>
struct TeachMeasures {
  const ComparedJoints<B>& joints;
  std::vector<TeachBaseline<B>> baselines{};
  /// Receives the mean motion of each item that is shown and its labels, "a, b": at the end, in the order of the items,
  /// in every process.
  std::function<void(const std::string& labels, const SmplVelpMotion<typename B::scalar>& mean,
                     const DescribedMotion& recorded)>
      made{};
  ShownTexts shows{};                     // the labels for `made`; empty: all
  Index samples = 10;                     // motions for each item
  Index window = 8;                       // frames between both actions that are interpolated
  Alignment alignment = Alignment::full;  // of the second action
  std::uint64_t seed = 0;
  AnyCommunicator communicator{};  // processes that share the items; all get the figures of all
};

struct TeachFigures {
  /// The rows of named_errors(SampledErrors), "mean of the latent", one for each baseline, and those of
  /// named_errors(BlindErrors).
  std::vector<NamedErrors> errors;
  /// How far joints jump from the first action to the second without interpolation: the mean over the items.
  struct Transition {
    std::string name;  // "turned and moved", "moved", the same for baselines, "recorded"
    double metres;
  };
  std::vector<Transition> transitions;
};

/// items  the chosen ones, for which has_two_actions is true. Throws cancelled, and what Teach::generate throws.
template <Backend B>
TeachFigures teach_figures(const TeachCheckpoint<B>& model, const MeasuredItems& items, const TeachMeasures<B>& how,
                           Progress progress = {}) {
  using S = typename B::scalar;
  struct Jumps {
    double aligned = 0, moved = 0;
    void add(const Jumps& other) { aligned += other.aligned, moved += other.moved; }
  };
  const auto recorded = [](const DescribedMotion& m) { return smplvelp_inverse(std::span<const float>(m.rows)); };
  const auto& training = items.data().training;
  const RifkeVariant variant = temos_rifke();
  const JointErrors none(variant);
  SampledErrors sampled(none, how.samples);
  JointErrors at_mean = none;
  std::vector<JointErrors> of_baselines(how.baselines.size(), none);
  BlindErrors blind(
      variant, none, std::ssize(training),
      [&](Index i) { return how.joints(recorded(training[static_cast<std::size_t>(i)])); }, how.seed);
  Jumps own;
  std::vector<Jumps> jumps(how.baselines.size());
  double real = 0;
  const auto rng = Philox{.seed = how.seed};
  const auto chosen = items.chosen();
  const auto item_of = [&](Index k) -> const DescribedMotion& { return *chosen[static_cast<std::size_t>(k)]; };
  const auto labels_text = [&](Index k) { return join_labels(labels_of(item_of(k)), Conjunction::comma); };
  const bool alone = how.communicator.size() == 1;
  const auto shown = shown_items(how.made != nullptr, std::ssize(chosen), how.shows, labels_text);
  const auto message_of = [&](Index k, const Progress&) {
    const DescribedMotion& item = item_of(k);
    const Index first = item.texts[0].frames.length;  // the rest is the transition and the second action
    const Offsets lengths{first, std::ssize(item.rows) / items.data().width - first};
    const auto labels = labels_of(item);
    const auto tokens = model.tokens(labels);
    const auto made = [&](Index sample, Index window, const LatentSampling& sampling) {
      return actions_to_motion(model.model, tokens, lengths, rng.split(static_cast<std::uint64_t>(sample)), window,
                               sampling);
    };
    const auto as_asked = [&](const Normalizer<B>& normalizer, const Sequences<B>& parts) {
      return teach_motion(normalizer, parts, how.window, how.alignment);
    };
    const auto jump = [&](const JointFrames& joints) {
      return transition_distance(std::span<const Vec3<double>>(joints), variant.joints, first);
    };
    const auto jumps_of = [&](const Normalizer<B>& normalizer, const Sequences<B>& parts) {
      return Jumps{jump(how.joints(teach_motion(normalizer, parts, 0, Alignment::full))),
                   jump(how.joints(teach_motion(normalizer, parts, 0, Alignment::translation)))};
    };
    const JointFrames truth = how.joints(recorded(item));
    std::vector<JointFrames> samples;
    for (Index s = 0; s < how.samples; ++s)
      samples.push_back(how.joints(as_asked(model.normalizer, made(s, how.window, {}))));
    MessageWriter out;
    put_clips(out, sampled.clips(samples, truth));
    const auto mean = as_asked(model.normalizer, made(0, how.window, {.mean = true}));
    std::vector<JointErrors::Clip> others{at_mean.clip(how.joints(mean), truth)};
    for (std::size_t b = 0; b < how.baselines.size(); ++b) {
      const TeachBaseline<B>& baseline = how.baselines[b];
      const auto parts = [&](Index window) {
        return baseline.parts(labels, lengths, rng.split(std::uint64_t{0}), window);
      };
      others.push_back(of_baselines[b].clip(how.joints(as_asked(baseline.normalizer, parts(how.window))), truth));
      out.value(jumps_of(baseline.normalizer, parts(0)));
    }
    out.value(jumps_of(model.normalizer, made(0, 0, {}))), out.value(jump(truth));
    put_clips(out, others);
    if (shown[static_cast<std::size_t>(k)]) put_smplvelp(out, mean);
    if (alone) blind.add(truth, items.number_in_training(k));
    return out.bytes();
  };
  Index next = 0;
  for (const std::string& message : shared_items(how.communicator, std::ssize(chosen), message_of, progress)) {
    const Index k = next++;
    MessageReader in(message);
    sampled.add(take_clips(in));
    for (Jumps& of_baseline : jumps) of_baseline.add(in.value<Jumps>());
    own.add(in.value<Jumps>()), real += in.value<double>();
    const auto others = take_clips(in);
    at_mean.add(others.front());
    for (std::size_t b = 0; b < of_baselines.size(); ++b) of_baselines[b].add(others[1 + b]);
    if (shown[static_cast<std::size_t>(k)]) how.made(labels_text(k), take_smplvelp<S>(in), item_of(k));
    if (!alone) blind.add(how.joints(recorded(item_of(k))), items.number_in_training(k));
  }

  TeachFigures out;
  out.errors = named_errors(sampled);
  out.errors.push_back({"mean of the latent", at_mean.result()});
  const auto count = static_cast<double>(chosen.size());
  const auto add = [&](const std::string& name, double sum) { out.transitions.push_back({name, sum / count}); };
  add("turned and moved", own.aligned), add("moved", own.moved);
  for (std::size_t b = 0; b < how.baselines.size(); ++b) {
    const auto& [name, has_parts, normalizer, parts] = how.baselines[b];
    out.errors.push_back({name, of_baselines[b].result()});
    add(has_parts ? name + ", turned and moved" : name, jumps[b].aligned);
    if (has_parts) add(name + ", moved", jumps[b].moved);
  }
  add("recorded", real);
  for (NamedErrors& row : named_errors(blind)) out.errors.push_back(std::move(row));
  return out;
}

MOTIONLANG_NAMESPACE_END
