// SPDX-License-Identifier: MIT
/// Motions for the texts of a batch, made by one model for another one. This measures if TMR finds generated motions.
///
///     const Tensor<B, 2> latents = tmr.encode_motion(synthesized_batch(*stmc, batch, features, normalizer, 7)).mu;
///
/// Source  TMR (Petrovich, Black, Varol, ICCV 2023), supplementary material: retrieval of generated motions
#pragma once

#include <algorithm>  // max
#include <cmath>      // lround
#include <cstdint>    // seed
#include <vector>     // rows

#include <motionlang/features/feature_rows.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/generate/motion_model.hpp>
#include <motionlang/train/text_motion_batch.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Each motion has the length of that in the batch.
/// features, normalizer  of the model that reads them
/// all                   processes that share the motions: each calls this function, and gets all of them
/// result                normalised rows of `features`
/// Throws                what generate_motions throws
template <Backend B>
Sequences<B> synthesized_batch(const MotionModel& model, const TextMotionBatch<B>& batch,
                               const MotionFeatures& features, const Normalizer<B>& normalizer, std::uint64_t seed,
                               const AnyCommunicator& all = AnyCommunicator()) {
  std::vector<Timeline> timelines;
  for (Index i = 0; i < batch.motions.count(); ++i) {
    const double seconds = static_cast<double>(batch.motions.offsets.length(i)) / features.fps;
    const Index frames = std::max<Index>(1, std::lround(seconds * model.fps()));
    timelines.push_back({{{batch.texts[static_cast<std::size_t>(i)], 0, frames, BodyParts::all()}}});
  }
  std::vector<typename B::scalar> values;
  std::vector<Index> frames;
  for (const Motion& motion : generate_motions(model, timelines, {.seed = seed, .communicator = all})) {
    const auto rows = rows_of_motion(features, motion, features.fps);
    for (const double x : rows) values.push_back(static_cast<typename B::scalar>(x));
    frames.push_back(std::ssize(rows) / features.width);
  }
  const Offsets offsets(frames);
  return {normalizer.normalize(Tensor<B, 2>::from(values, {offsets.rows(), features.width})), offsets};
}

MOTIONLANG_NAMESPACE_END
