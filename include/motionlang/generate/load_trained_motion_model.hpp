// SPDX-License-Identifier: MIT
/// Loads models of train-temos, train-tmr, train-sinc, train-teach and train-actor, and published TMR, as a
/// MotionModel. They are not in load_motion_model.hpp, because they take as long to compile as all others.
///
///     const auto model = load_motion_model<B>("runs/temos", {.trained = load_trained_motion_model<B>});
#pragma once

#include <motionlang/generate/load_motion_model.hpp>
#include <motionlang/weights/actor_checkpoint.hpp>
#include <motionlang/weights/sinc_checkpoint.hpp>
#include <motionlang/weights/teach_checkpoint.hpp>
#include <motionlang/weights/temos_checkpoint.hpp>
#include <motionlang/weights/tmr_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// ACTOR from our training.
template <Backend B>
std::unique_ptr<MotionModel> load_trained_actor_motion_model(const FilePath& folder) {
  ActorModel<B> model = load_actor<B>(folder);
  const ActorClipsConfig clips = model.file.config.clips;
  return actor_motion_model_of_clips<B>(std::move(model.actor), model.file.labels, clips,
                                        clips.num_frames > 0 ? clips.num_frames : clips.max_len);
}

/// Throws what the loaders of the systems throw.
template <Backend B>
std::unique_ptr<MotionModel> load_trained_motion_model(const MotionModelPlace& place, const ModelSources& sources) {
  const CheckpointOptions options{.text_encoder = sources.text_encoder, .statistics = sources.statistics};
  if (place.system == "trained actor") return load_trained_actor_motion_model<B>(place.path);
  if (place.system == "trained sinc") return sinc_motion_model(text_latents(load_sinc<B>(place.path, options)));
  if (place.system == "trained teach") return teach_motion_model(text_latents(load_teach<B>(place.path, options)));
  if (place.system == "trained temos") return text_motion_model(text_latents(load_temos<B>(place.path, options)));
  return text_motion_model(text_latents(load_tmr<B>(place.path, options)));
}

MOTIONLANG_NAMESPACE_END
