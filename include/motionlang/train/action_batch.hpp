// SPDX-License-Identifier: MIT
/// Windows of motions with the classes of their actions, from which ACTOR and its classifiers learn. Also the sets of
/// motions for evaluating ACTOR.
#pragma once

#include <span>    // numbers of motions
#include <vector>  // classes

#include <motionlang/core/python_random.hpp>
#include <motionlang/train/batch_parts.hpp>
#include <motionlang/weights/actor_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A batch of windows.
template <Backend B>
struct ActionBatch {
  Sequences<B> x;
  std::vector<Index> classes;
};
/// Every window has a generator of its own, so it does not depend on the others.
template <Backend B>
ActionBatch<B> action_batch(const std::vector<DescribedMotion>& motions, std::span<const Index> classes,
                            std::span<const Index> which, const ActorClipsConfig& clips, Philox rng) {
  ActionBatch<B> out;
  std::vector<typename B::scalar> values;
  std::vector<Index> lengths;
  for (const Index i : which) {
    PythonRandom random(std::uint64_t{rng.bits()});
    const auto window = actor_window(motions[static_cast<std::size_t>(i)], clips, random);
    values.insert(values.end(), window.begin(), window.end());
    lengths.push_back(std::ssize(window) / clips.width());
    out.classes.push_back(classes[static_cast<std::size_t>(i)]);
  }
  const Offsets offsets{std::span<const Index>(lengths)};
  out.x = {Tensor<B, 2>::from(values, {offsets.rows(), clips.width()}), offsets};
  return out;
}

/// The windows of a part of a batch.
template <Backend B>
ActionBatch<B> part_of(const ActionBatch<B>& batch, const BatchPart& part) {
  const auto classes = part.of(batch.classes);
  return {part_of(batch.x, part), {classes.begin(), classes.end()}};
}

/// For each of these motions a random other one of its class, or itself if there is no other.
std::vector<Index> others_of_class(std::span<const Index> which, std::span<const Index> classes, Philox& rng);

/// Recorded motions, and motions that an ACTOR makes from them, for a classifier: the sets of thesis table 3.8. Every
/// call returns one motion for each number, with its action and the length of its window.
template <Backend B>
struct RecognitionSets {
  using Numbers = std::span<const Index>;

  const ActorModel<B>& model;
  const std::vector<DescribedMotion>& motions;
  Numbers classes;                // of the motions
  const ActorClipsConfig& clips;  // of the motions: the model's; any for `sampled`, which uses only lengths
  const ActorClipsConfig& seen;   // by the classifier

  ActionBatch<B> recorded(Numbers which, const Philox& windows) const {
    return shown(which, windows, [](const ActionBatch<B>& b) { return b.x; });
  }
  ActionBatch<B> denoised(Numbers which, const Philox& windows) const {
    return shown(which, windows, [&](const ActionBatch<B>& b) { return denoise(model.actor, b.x, b.classes); });
  }
  /// Motions between each motion and another of its action.
  ActionBatch<B> interpolated(Numbers which, const Philox& windows, const Philox& windows_of_others, Philox rng) const {
    return shown(which, windows, [&](const ActionBatch<B>& b) {
      const auto others = others_of_class(which, classes, rng);
      return model.between(b.x, batch(others, windows_of_others).x, b.classes, rng);
    });
  }
  ActionBatch<B> sampled(Numbers which, const Philox& windows, Philox noise) const {
    return shown(which, windows, [&](const ActionBatch<B>& b) {
      std::vector<Index> lengths;
      for (Index i = 0; i < b.x.count(); ++i) lengths.push_back(b.x.offsets.length(i));
      return generate(model.actor, b.classes, lengths, noise);
    });
  }

 private:
  ActionBatch<B> batch(Numbers which, const Philox& windows) const {
    return action_batch<B>(motions, classes, which, clips, windows);
  }
  template <class Make>
  ActionBatch<B> shown(Numbers which, const Philox& windows, Make make) const {
    auto b = batch(which, windows);
    b.x = model.seen_by(make(b), seen);
    return b;
  }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/action_batch.ipp>
#endif
