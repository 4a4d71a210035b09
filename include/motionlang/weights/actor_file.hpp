// SPDX-License-Identifier: MIT
/// ACTOR and the classifiers that judge it from their published checkpoints: sizes come from the shapes of the tensors.
///
///     const auto actor = load_actor<B>(open_weights(run.weights), run);     // run = find_run("exps/humanact12"); or
///     weights/vae_run.hpp const auto gru =
///     load_gru_classifier<B>(open_weights("models/actionrecognition/humanact12_gru.tar")); const auto stgcn =
///     load_stgcn<B>(open_weights("models/actionrecognition/uestc_rot6d_stgcn.tar"));
///
/// Options  opt.yaml of the run says what shapes do not: pose_rep, activation, num_heads, ablation, num_frames,
///          max_len, sampling, sampling_step, jointstype. Without it the published values: 6D rotations, GELU, 4 heads,
///          none, 60 consecutive frames, vertices
/// Ignored  tables of positions (*.pe), SMPL
/// Throws   io_error 404 for variants that are not known, 406, 407 if names or shapes do not match; config_error 102
///          where options and tensors differ, 101, 103, 107 for options that mean nothing; numeric_error 301 for a
///          number that is none
/// Source   spec actor.md 2.8, 3.1, 3.2, 6.3, 7.2, 7.3
#pragma once

#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/systems/actor.hpp>
#include <motionlang/weights/detail/run_reader.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

ActorConfig actor_config(const RunReader& r);

}  // namespace detail

/// Frames of the longest motions that a run learned from: num_frames. Where that is -1 (whole clips) or -2 (windows of
/// any length) it is max_len, and where this is -1 as well what the table of positions has room for, beside two tokens.
/// Spec actor.md 6.3
Index actor_longest(const RunFolder& run, const TensorSet& weights, const ActorConfig& config);

/// How a run chose frames of a clip: sampling and sampling_step.
ActorFrameOptions actor_frame_options(const RunFolder& run, const TensorSet& weights);

/// The points of a body that the loss of a run compares: jointstype. Throws config_error 103.
inline ActorPoints actor_loss_points(const RunFolder& run, const TensorSet& weights) {
  return parse_actor_points(detail::RunReader(run, weights, "").text("jointstype", "vertices"));
}

/// How a run writes motions, for `actor_points`.
ActorPointOptions actor_point_options(const RunFolder& run, const TensorSet& weights);

/// `run` has the options, if there are any.
template <Backend B>
Actor<B> load_actor(const TensorSet& file, const RunFolder& run = {}) {
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
  const RunFolder no_options{};
  const detail::RunReader t(no_options, file, "");
  const auto room = detail::room_of(file);
  NoInit zeros;
  GruClassifier<B> model({.input_size = t.size("recurrent.weight_ih_l0", 1),
                          .hidden_size = t.size("recurrent.weight_hh_l0", 1),
                          .num_layers = t.count("recurrent.weight_ih_l", "", {}),
                          .num_classes = t.size("linear2.weight", 0)},
                         zeros);
  load_module(model, file);
  return model;
}

/// The graph is that of the file. A block that has a convolution past it halves the frames, as published.
template <Backend B>
StGcn<B> load_stgcn(const TensorSet& file) {
  const RunFolder no_options{};
  const detail::RunReader t(no_options, file, "");
  auto shape = [&](const std::string& name, int rank) {
    const TensorView& view = file.tensor(name);
    if (view.shape.rank() != rank) raise<io_error>(407, file.name(), ": tensor '", name, "' is ", view.shape);
    return view.shape;
  };
  const FileShape edges = shape("A", 3);
  const Index joints = edges[1], numbers = shape("data_bn.weight", 1)[0];
  if (edges[0] < 1 || edges[2] != joints) raise<io_error>(407, file.name(), ": tensor 'A' is ", edges);
  StGcnConfig c{.in_channels = numbers / std::max<Index>(joints, 1),
                .num_classes = shape("fcn.weight", 4)[0],
                .channels = {},
                .strides = {}};
  c.parents.assign(static_cast<std::size_t>(joints), -1);
  const std::string block = "st_gcn_networks.";
  for (Index i = 0; t.has(concat_text(block, i, ".tcn.2.weight")); ++i) {
    const std::string name = concat_text(block, i);
    c.channels.push_back(shape(name + ".tcn.2.weight", 4)[0]);
    c.strides.push_back(t.has(name + ".residual.0.weight") ? 2 : 1);
  }
  const auto room = detail::room_of(file);
  NoInit zeros;
  StGcn<B> model(c, zeros);
  load_module(model, file);
  return model;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/actor_file.ipp>
#endif
