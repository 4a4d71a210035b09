// SPDX-License-Identifier: MIT
/// Motions of any model of texts, as the evaluator of Guo et al. takes them: STMC, MDM, MotionDiffuse, TEMOS, TMR, SINC
/// and TEACH. TM2T has a maker of its own in train/guo_evaluation.hpp.
///
///     const auto model = load_motion_model<B>("models/mdm");
///     const auto figures = guo_figures(guo_maker<B>(*model, judge.width()), judge, items, {.replications = 20});
///
/// A motion has the length of the recorded one, as in MDM's evaluation, unless the model cannot make that many frames.
/// Motions are what the model itself calculates: nothing is smoothed, floor and feet are not fixed.
/// Source  Guo et al. (CVPR 2022), section 5.2; Tevet et al. (ICLR 2023), section 4
#pragma once

#include <cstdint>   // seeds
#include <optional>  // what the caller leaves to the model
#include <span>      // motions
#include <vector>    // rows

#include <motionlang/generate/motion_model.hpp>
#include <motionlang/train/communicator.hpp>
#include <motionlang/train/guo_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Settings of diffusion models; the defaults are the model's. Other models ignore them.
struct GuoMakingOptions {
  std::optional<Index> steps{};
  std::optional<double> guidance{};
  AnyCommunicator communicator{};  // processes that share the motions of a batch; never those that share replications
};

/// The rows of the motions, not normalised, each with at most the wanted number of frames.
/// width   263 for HumanML3D's features, 251 for KIT's
/// Throws  config_error 103 for another width, and what generate_motions throws
std::vector<std::vector<double>> guo_made(const MotionModel& model, Index width, std::span<const GuoWanted> wanted,
                                          std::uint64_t seed, const GuoMakingOptions& options = {});

/// The model must outlive the maker.
template <Backend B>
GuoMaker<B> guo_maker(const MotionModel& model, Index width, const GuoMakingOptions& options = {}) {
  return [&model, width, options](std::span<const GuoWanted> wanted, const Philox& rng) {
    auto draw = rng;
    const std::uint64_t high = draw.bits(), low = draw.bits();
    std::vector<typename B::scalar> values;
    std::vector<Index> frames;
    for (const auto& rows : guo_made(model, width, wanted, high << 32 | low, options)) {
      for (const double x : rows) values.push_back(static_cast<typename B::scalar>(x));
      frames.push_back(std::ssize(rows) / width);
    }
    const Offsets offsets(frames);
    return Sequences<B>{Tensor<B, 2>::from(values, {offsets.rows(), width}), offsets};
  };
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/guo_motions.ipp>
#endif
