// SPDX-License-Identifier: MIT
/// A training step of TEACH: two actions that follow each other, each with the branches and losses of TEMOS.
#pragma once

#include <motionlang/vae/text_motion.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// A batch. The features of a pair are canonicalised and normalised as one motion and then cut.
template <Backend B>
struct TeachPairs {
  Sequences<B> first_text, second_text;      // the last states of the language model
  Sequences<B> first_motion, second_motion;  // the second one: transition and action
  Offsets transition;                        // frames of the transitions
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
};

/// The terms of temos_losses for the first action (their names end in _0) and the second (_1).
/// Source  spec teach.md 3
template <Backend B>
LossTerms<B> teach_losses(const TeachBranches<B>& branches, const TeachPairs<B>& pairs,
                          const TeachLossOptions& options = {}) {
  LossTerms<B> out;
  out.append(temos_losses(branches.first, pairs.first_motion, options.each), "_0");
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
  out.append(temos_losses(second, motion, options.each), "_1");
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
