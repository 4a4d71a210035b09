// SPDX-License-Identifier: MIT
/// ACTOR and the classifiers that judge it from their published checkpoints: sizes come from the shapes of the tensors.
///
///     const RunFolder run = find_run("exps/humanact12");  // or load_actor_run, weights/vae_run.hpp
///     const auto actor = actor_network<B>(open_weights(run.weights), run);
///     const auto gru = load_gru_classifier<B>(open_weights("models/actionrecognition/humanact12_gru.tar"));
///     const auto stgcn = load_stgcn<B>(open_weights("models/actionrecognition/uestc_rot6d_stgcn.tar"));
///
/// Options  opt.yaml of the run gives what shapes do not show: pose_rep, activation, num_heads, ablation, num_frames,
///          max_len, sampling, sampling_step, jointstype. Without it the published values: 6D rotations, GELU, 4 heads,
///          no ablation, 60 consecutive frames, vertices
/// Ignored  tables of positions (*.pe), SMPL
/// Throws   io_error 404 for unknown variants, 406, 407 if names or shapes do not match; config_error 102 if options
///          and tensors differ, 101, 103, 107 for invalid options; numeric_error 301 for NaN or infinity
/// Source   ACTOR src/models/architectures, src/evaluate/action2motion/models.py, src/recognition/models/stgcn.py:
///          names of the modules
#pragma once

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/systems/actor.hpp>
#include <motionlang/weights/detail/run_reader.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

ActorConfig actor_config(const RunReader& r);
GruClassifierConfig gru_classifier_config(const TensorSet& file);
StGcnConfig stgcn_config(const TensorSet& file);

}  // namespace detail

/// The frames of the longest motions in the training of a run: num_frames. If that is -1 (whole clips) or -2 (windows
/// of any length), it is max_len. If this is -1 as well, it is the size of the table of positions without two tokens.
/// Source  ACTOR src/datasets/dataset.py _get_item_data_index
Index actor_longest(const RunFolder& run, const TensorSet& weights, const ActorConfig& config);

/// The choice of frames of a clip in a run: sampling and sampling_step.
ActorFrameOptions actor_frame_options(const RunFolder& run, const TensorSet& weights);

/// The points of a body that the loss of a run compares: jointstype. Throws config_error 103.
inline ActorPoints actor_loss_points(const RunFolder& run, const TensorSet& weights) {
  return parse_actor_points(detail::RunReader(run, weights, "").text("jointstype", "vertices"));
}

/// True if pose_rep is xyz: a frame has the position of each joint, and no rotations.
inline bool actor_has_positions(const RunFolder& run, const TensorSet& weights) {
  return detail::RunReader(run, weights, "").text("pose_rep", "rot6d") == "xyz";
}

/// The form of a run's motions, for `actor_points`. Throws config_error 103 for positions.
ActorPointOptions actor_point_options(const RunFolder& run, const TensorSet& weights);

/// `run` holds the options, if there are any.
template <Backend B>
Actor<B> actor_network(const TensorSet& file, const RunFolder& run = {}) {
  const ActorConfig config = detail::actor_config(detail::RunReader(run, file, ""));
  const auto room = detail::room_of(file);
  NoInit zeros;
  Actor<B> model(config, zeros);
  detail::load_run_module(model, file, "", [](const std::string& name) {
    return name.ends_with(".pe") || name.starts_with("rotation2xyz.");
  });
  return model;
}

/// The tensors are in the file's entry "model", which open_weights finds.
template <Backend B>
GruClassifier<B> load_gru_classifier(const TensorSet& file) {
  const GruClassifierConfig config = detail::gru_classifier_config(file);
  const auto room = detail::room_of(file);
  NoInit zeros;
  GruClassifier<B> model(config, zeros);
  load_module(model, file);
  return model;
}

/// The graph is that of the file. A block with a convolution beside it halves the frames, as published.
template <Backend B>
StGcn<B> load_stgcn(const TensorSet& file) {
  const StGcnConfig config = detail::stgcn_config(file);
  const auto room = detail::room_of(file);
  NoInit zeros;
  StGcn<B> model(config, zeros);
  load_module(model, file);
  return model;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/actor_file.ipp>
#endif
