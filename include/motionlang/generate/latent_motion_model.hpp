// SPDX-License-Identifier: MIT
/// Models with one latent for every motion (ACTOR, TEMOS, TMR, SINC). They also make motions between two texts or
/// actions, and denoise motions.
///
///     if (const LatentMotionModel* latent = model->latent())
///       auto line = latent->between(walk, run, 5, {.seed = 7});    // from a walk to a run
#pragma once

#include <motionlang/generate/motion_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class LatentMotionModel : public SeparateMotionModel {
 public:
  std::string system() const final { return "a model with one latent for every motion"; }
  bool draws_latents() const override { return true; }
  const LatentMotionModel* latent() const final { return this; }

  /// `count` motions on the straight line from the latent of one timeline to that of another, with the same noise. The
  /// first and the last equal those that generate_motion makes for each alone.
  /// to      has the length of `from`
  /// Throws  option_error 101 unless count is 2 or more, and what generate_motion throws
  std::vector<Motion> between(const Timeline& from, const Timeline& to, Index count,
                              const GenerateOptions& options) const;

  /// A motion encoded and decoded by the model, on the joints of the model, at its old place and rate. A motion longer
  /// than those of the training is processed in parts, which share a quarter of their frames and are blended.
  /// action  of the motion, for ACTOR; "" for others
  /// Throws  option_error 102 if the action is missing or not needed, config_error 103 for an unknown one, and what the
  ///         features throw
  Motion denoised(const Motion& motion, const std::string& action = "") const;

 private:
  virtual std::vector<Motion> line(const Timeline& from, const Timeline& to, Index count, Philox noise,
                                   double fact) const = 0;
  /// Encodes and decodes. The motion has the rate of the model.
  virtual Motion decoded(const Motion& motion, const std::string& action) const = 0;
  virtual Index longest() const = 0;  // frames of the longest training motion
  /// The motion on joints that `decoded` takes: SMPL's 24, or those of the model's features.
  virtual Motion on_its_joints(const Motion& motion) const = 0;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/latent_motion_model.ipp>
#endif
