// SPDX-License-Identifier: MIT
/// A training step of TEACH: two actions in sequence, each with the branches and losses of TEMOS.
#pragma once

#include <algorithm>  // max

#include <motionlang/vae/text_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A batch. The features of a pair are canonicalised and normalised as one motion, and then cut.
template <Backend B>
struct TeachPairs {
  Sequences<B> first_text, second_text;         // the last states of the language model
  Sequences<B> first_motion, second_motion;     // the second one: transition and action
  Offsets transition;                           // frames of the transitions
  Index longest_first = 0, longest_second = 0;  // frames of the longest motions, if the batch has longer ones
};
template <Backend B>
struct TeachNoise {
  TextMotionNoise<B> first, second;

  static TeachNoise draw(Index pairs, Index width, const Philox& rng, double fact = 1) {
    return {TextMotionNoise<B>::draw(pairs, width, rng.split("first"), fact),
            TextMotionNoise<B>::draw(pairs, width, rng.split("second"), fact)};
  }
};
template <Backend B>
struct TeachBranches {
  TextMotionBranches<B> first, second;
  Sequences<B> past;  // the frames that the second text was encoded with
};

struct TeachLossOptions {
  TemosLossOptions each{.feats = "rfeats",
                        .mean = ReconstructionMean::sequences};  // weights, the same for both actions
  bool loss_on_transition = true;                                // false: reconstructions leave the transition out
  double velocity = 0;  // of a term that the published code has, with 0.5, but cannot run
};

///     velocity_text2rfeats, velocity_rfeats2rfeats     smooth_l1 of the steps from frame to frame, without height and
///                                                      velocity of the root (columns 0 to 2), averaged over sequences
template <Backend B>
LossTerms<B> teach_velocity_losses(const TextMotionBranches<B>& branches, const Sequences<B>& motion, double weight) {
  PoolVector<Index> lengths;
  for (Index i = 0; i < motion.count(); ++i) lengths.push_back(std::max<Index>(motion.offsets.length(i) - 1, 0));
  const Offsets steps{std::span<const Index>(lengths)};
  auto velocity = [&](const Sequences<B>& x) { return Sequences<B>(slice(frame_steps(x), 1, 3, x.width()), steps); };
  LossTerms<B> out;
  auto add = [&](const char* name, const Tensor<B, 2>& frames) {
    out.add(name, weight, smooth_l1_of_sequences(velocity(motion), velocity(motion.with(frames)).rows));
  };
  add("velocity_text2rfeats", branches.text.frames);
  if (branches.motion) add("velocity_rfeats2rfeats", branches.motion->frames);
  return out;
}

/// The terms of temos_losses (and velocities, if they have a weight): for the first action with names that end in _0,
/// for the second in _1.
/// Source  thesis A.2.3: thesis eq. A.1 (recons_*) and thesis eq. A.2 (kl_text, kl_motion), with the other terms of
///         TEMOS; TEACH teach/model/losses/compute_teach.py
template <Backend B>
LossTerms<B> teach_losses(const TeachBranches<B>& branches, const TeachPairs<B>& pairs,
                          const TeachLossOptions& options = {}) {
  LossTerms<B> out;
  auto add = [&](const TextMotionBranches<B>& action, const Sequences<B>& motion, const char* suffix) {
    out.append(temos_losses(action, motion, options.each), suffix);
    if (options.velocity != 0) out.append(teach_velocity_losses(action, motion, options.velocity), suffix);
  };
  add(branches.first, pairs.first_motion, "_0");  // the first terms of thesis eq. A.1 and thesis eq. A.2
  auto second = branches.second;
  auto motion = pairs.second_motion;
  if (!options.loss_on_transition) {
    PoolVector<Index> lengths;
    for (Index i = 0; i < motion.count(); ++i) lengths.push_back(motion.offsets.length(i) - pairs.transition.length(i));
    const Offsets action{std::span<const Index>(lengths)};
    auto cut = [&](Tensor<B, 2>& frames) { frames = last_rows(motion.with(frames), action).rows; };
    cut(second.text.frames);
    if (second.motion) cut(second.motion->frames);
    motion = last_rows(motion, action);
  }
  add(second, motion, "_1");  // their second terms
  return out;
}

MOTIONLANG_NAMESPACE_END
