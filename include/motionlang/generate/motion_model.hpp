// SPDX-License-Identifier: MIT
/// One interface for all models that make motions from texts or actions: STMC, MDM, MotionDiffuse, ACTOR, TEMOS, TMR,
/// TEACH, SINC, TM2T.
///
///     const auto model = load_motion_model<EigenBackend<float>>("exps/humanact12");    // load_motion_model.hpp
///     const Motion motion = generate_motion(*model, whole_body_timeline("walk", 60), {.seed = 7});
#pragma once

#include <memory>  // models
#include <span>    // timelines
#include <string>  // texts
#include <vector>  // motions

#include <motionlang/compose/timeline.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/generate/generate_options.hpp>
#include <motionlang/text/known_captions.hpp>
#include <motionlang/text/known_words.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class LatentMotionModel;

/// The word pieces of a text, and how many of them a model reads.
struct TextLength {
  Index pieces = 0, read = 0;
};

/// A loaded model.
class MotionModel {
 public:
  virtual ~MotionModel() = default;

  /// One motion for each timeline, in their order. Throws what check_options, the system and shared_motions throw.
  std::vector<Motion> generate(std::span<const Timeline> timelines, const GenerateOptions& options) const;

  virtual double fps() const = 0;
  /// The kind of model, for messages: "a diffusion model".
  virtual std::string system() const = 0;
  /// The number of its diffusion steps; 0: none.
  virtual Index steps() const { return 0; }
  /// True if it goes through STMC: texts at the same time, body parts, noise, record, reuse and keep.
  virtual bool takes_timelines() const { return false; }
  /// The most frames that it makes of one text, with what it shares with its neighbours; 0: it has no such limit, or
  /// says it only when it makes them.
  virtual Index longest_crop() const { return 0; }
  /// True if its texts are names or numbers of actions.
  virtual bool takes_actions() const { return false; }
  /// True if its motions come from latents with noise in them.
  virtual bool draws_latents() const { return false; }
  /// The words that it knows. Empty if its weights do not list them.
  virtual const KnownWords& words() const;
  /// The captions that it learned from. Empty if its weights do not have them.
  virtual const KnownCaptions& captions() const;
  /// The length of a text, and the length that the model reads. None without such a limit.
  virtual TextLength length_of(const std::string&) const { return {}; }
  /// The same model as one with a latent for every motion. Null if it has none.
  virtual const LatentMotionModel* latent() const { return nullptr; }

 private:
  virtual std::vector<Motion> make(std::span<const Timeline> timelines, const GenerateOptions& options) const = 0;
  /// Throws option_error 102 if several processes cannot share the timelines.
  virtual void require_shareable(std::span<const Timeline>, const GenerateOptions&) const {}
};

/// Throws option_error 102 for options that a model does not take, and 105 for more steps than it has.
void check_options(const MotionModel& model, const GenerateOptions& options);

std::vector<Motion> generate_motions(const MotionModel& model, std::span<const Timeline> timelines,
                                     const GenerateOptions& options = {});
Motion generate_motion(const MotionModel& model, const Timeline& timeline, const GenerateOptions& options = {});

/// A model that makes every motion alone, from its texts and from noise. The noise depends on the seed and on the place
/// of the motion in the list.
class SeparateMotionModel : public MotionModel {
 protected:
  /// The noise of the motion at this place.
  static Philox noise_of(const GenerateOptions& options, std::uint64_t place) {
    return Philox{.seed = options.seed}.split("noise").split(place);
  }

 private:
  std::vector<Motion> make(std::span<const Timeline> timelines, const GenerateOptions& options) const final;
  virtual Motion motion(const Timeline& timeline, Philox noise, const GenerateOptions& options) const = 0;
};

/// A timeline of one text for the whole body.
Timeline whole_body_timeline(std::string text, Index frames);
/// The only text of a timeline. Throws timeline_error 509.
const Interval& only_text(const Timeline& timeline);
/// The number of an action, given by name or number. Throws config_error 103 for an unknown one.
Index action_of(const std::string& text, std::span<const std::string> labels, Index classes);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/motion_model.ipp>
#endif
