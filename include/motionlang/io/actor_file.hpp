// SPDX-License-Identifier: MIT
/// ACTOR and the classifiers that judge it from their published checkpoints: sizes come from the shapes of the tensors.
///
///     const auto actor = load_actor<B>("exps/humanact12");          // a run folder, or a checkpoint_5000.pth.tar in it
///     const auto gru = load_gru_classifier<B>(open_weights("models/actionrecognition/humanact12_gru.tar"));
///     const auto stgcn = load_stgcn<B>(open_weights("models/actionrecognition/uestc_rot6d_stgcn.tar"));
///
/// Options  opt.yaml beside the weights says what shapes do not: pose_rep, activation, num_heads, num_frames, ablation. Without it the
///          published values: 6D rotations, GELU, 4 heads, 60 frames, none
/// Ignored  tables of positions (*.pe)
/// Throws   io_error 406, 407 if names or shapes do not match, 404 for an ablation that is not known; config_error 101, 103, 107 for
///          options that mean nothing; numeric_error 301 for a number that is none
/// Source   spec actor.md 2.8, 3.1, 3.2, 7.2, 7.3
#pragma once

#include <motionlang/io/detail/shape_reader.hpp>
#include <motionlang/io/weight_file.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/systems/actor.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

namespace detail {

inline std::string actor_option(const std::vector<FileValue>& options, std::string_view key, const char* otherwise) {
  const FileValue* v = find_value(options, key);
  return v == nullptr ? otherwise : to_string(*v);
}
inline Index actor_number(const std::vector<FileValue>& options, std::string_view key, Index otherwise) {
  const FileValue* v = find_value(options, key);
  if (v == nullptr) return otherwise;
  const auto* n = std::get_if<std::int64_t>(&v->value);
  if (n == nullptr || *n < 1 || *n > 100'000)
    raise<config_error>(107, "option ", key, " is '", to_string(*v), "', not a number of 1 ... 100000");
  return static_cast<Index>(*n);
}
inline bool actor_switch(const std::vector<FileValue>& options, std::string_view key, bool otherwise) {
  const FileValue* v = find_value(options, key);
  if (v == nullptr) return otherwise;
  const auto* b = std::get_if<bool>(&v->value);
  if (b == nullptr) raise<config_error>(107, "option ", key, " is '", to_string(*v), "', not true or false");
  return *b;
}

}  // namespace detail

/// How a run writes motions, for `actor_points`. options: those of opt.yaml.
inline ActorPointOptions actor_point_options(const std::vector<FileValue>& options) {
  ActorPointOptions out{
      .features = {.rotations = parse_pose_representation(detail::actor_option(options, "pose_rep", "rot6d")),
                   .translation = detail::actor_switch(options, "translation", true),
                   .global = detail::actor_switch(options, "glob", true)},
      .translate = detail::actor_switch(options, "vertstrans", false)};
  double* const axes[] = {&out.global_rotation.x, &out.global_rotation.y, &out.global_rotation.z};
  for (std::size_t i = 0; i < 3; ++i) {
    const FileValue* v = find_value(options, concat_text("glob_rot/", i));
    if (v == nullptr) continue;
    if (const auto* d = std::get_if<double>(&v->value))
      *axes[i] = *d;
    else if (const auto* n = std::get_if<std::int64_t>(&v->value))
      *axes[i] = static_cast<double>(*n);
    else
      raise<config_error>(107, "option glob_rot is '", to_string(*v), "', not numbers");
  }
  return out;
}

inline ActorConfig actor_config_of(const TensorSet& file, const std::vector<FileValue>& options = {}) {
  const detail::ShapeReader t(file);
  const std::string e = "encoder.", d = "decoder.", linear1 = ".layers.0.linear1.weight";
  ActorConfig c{.num_heads = detail::actor_number(options, "num_heads", 4),
                .activation = parse_activation(detail::actor_option(options, "activation", "gelu")),
                .num_frames = detail::actor_number(options, "num_frames", 60)};
  if (t.has(e + "muQuery")) {
    c.latent_dim = t.size(e + "muQuery", 1);
  } else if (t.has(e + "mu_layer.weight")) {
    c.encoder = ActorEncoderKind::average;
    c.latent_dim = t.size(e + "mu_layer.weight", 0);
  } else {
    c.encoder = t.has(e + "gru.weight_ih_l0") ? ActorEncoderKind::gru : ActorEncoderKind::fully_connected;
    c.latent_dim = t.size(e + "mu.weight", 0);
  }
  Index features = 0;
  if (t.has(d + "finallayer.weight")) {
    features = t.size(d + "finallayer.weight", 0);
    const bool one_hot = t.has(d + "ztimelinear.weight");
    c.num_classes = one_hot ? t.size(d + "ztimelinear.weight", 1) - c.latent_dim : t.size(d + "actionBiases", 0);
    const std::string ablation = detail::actor_option(options, "ablation", "");
    if (one_hot)
      c.conditioning = ActorConditioning::zandtime;
    else if (ablation == "concat_bias")
      c.conditioning = ActorConditioning::concat_bias;
    else if (ablation == "time_encoding")
      c.conditioning = ActorConditioning::time_encoding;
    else if (!ablation.empty() && ablation != "average_encoder")
      raise<io_error>(404, file.name(), ": ablation '", ablation, "' of its options is not known");
  } else if (t.has(d + "gru.weight_ih_l0")) {
    c.decoder = ActorDecoderKind::gru;
    features = t.size(d + "final_layer.weight", 0);
    c.num_classes = t.size(d + "feats_embedding.weight", 1) - c.latent_dim - 1;
  } else if (t.has(d + "embedding_x.weight")) {
    c.decoder = ActorDecoderKind::autoregressive;
    features = t.size(d + "output_layer.weight", 0);
    c.num_classes = t.size(d + "embedding_x.weight", 1) - features - 1;
  } else {
    c.decoder = ActorDecoderKind::fully_connected;
    features = t.size(d + "fully_connected.4.weight", 0) / c.num_frames;
    c.num_classes = t.size(d + "fully_connected.0.weight", 1) - c.latent_dim;
  }
  c.nfeats = size(parse_pose_representation(detail::actor_option(options, "pose_rep", "rot6d")));
  c.njoints = features / c.nfeats;
  c.num_layers =
      std::max({t.layers(e + "seqTransEncoder"), t.layers(d + "seqTransDecoder"), t.count(e + "gru.weight_ih_l"),
                t.count(d + "gru.weight_ih_l"), t.count(d + "layers.", ".trg_trg_att.k_layer.weight")});
  for (const std::string& name : {e + "seqTransEncoder" + linear1, d + "seqTransDecoder" + linear1,
                                  d + "layers.0.feed_forward.pwff_layer.0.weight"}) {
    if (t.has(name)) c.ff_size = t.size(name, 0);
  }
  if (c.num_classes < 1 || c.njoints < 1)
    raise<io_error>(407, file.name(), ": its shapes leave ", c.num_classes, " classes and ", c.njoints, " joints");
  return c;
}

template <Backend B>
Actor<B> load_actor(const TensorSet& file, const std::vector<FileValue>& options = {}) {
  NoInit zeros;
  Actor<B> model(actor_config_of(file, options), zeros);
  detail::load_with_company(model, file, [](const std::string& name) { return name.ends_with(".pe"); });
  return model;
}
/// A run folder, of which the last checkpoint is taken, or a checkpoint beside its opt.yaml.
template <Backend B>
Actor<B> load_actor(const FilePath& path) {
  const std::filesystem::path place(path.string());
  const bool folder = std::filesystem::is_directory(place);
  const std::filesystem::path around = place.parent_path();
  const RunFolder run = find_run(folder ? place : around.empty() ? std::filesystem::path(".") : around);
  if (folder && run.weights.empty())
    raise<io_error>(401, path.string(), ": no checkpoint of ACTOR (checkpoint_5000.pth.tar) in this folder");
  return load_actor<B>(open_weights(folder ? run.weights : place), run.options);
}

/// The tensors are in the file's entry "model", which open_weights finds.
template <Backend B>
GruClassifier<B> load_gru_classifier(const TensorSet& file) {
  const detail::ShapeReader t(file);
  NoInit zeros;
  GruClassifier<B> model({.input_size = t.size("recurrent.weight_ih_l0", 1),
                          .hidden_size = t.size("recurrent.weight_hh_l0", 1),
                          .num_layers = t.count("recurrent.weight_ih_l"),
                          .num_classes = t.size("linear2.weight", 0)},
                         zeros);
  load_module(model, file);
  return model;
}

/// The graph is that of the file. A block that has a convolution past it halves the frames, as published.
template <Backend B>
StGcn<B> load_stgcn(const TensorSet& file) {
  const detail::ShapeReader t(file);
  auto shape = [&](const std::string& name, int rank) {
    const TensorView& view = file.tensor(name);
    if (view.shape.rank() != rank) raise<io_error>(407, file.name(), ": tensor '", name, "' is ", view.shape);
    return view.shape;
  };
  const Index joints = shape("A", 3)[1], numbers = shape("data_bn.weight", 1)[0];
  StGcnConfig c{.in_channels = numbers / std::max<Index>(joints, 1),
                .num_classes = shape("fcn.weight", 4)[0],
                .channels = {},
                .strides = {}};
  c.parents.assign(static_cast<std::size_t>(joints), -1);
  const std::string block = "st_gcn_networks.";
  for (Index i = 0; i < t.count(block, ".tcn.2.weight"); ++i) {
    const std::string name = concat_text(block, i);
    c.channels.push_back(shape(name + ".tcn.2.weight", 4)[0]);
    c.strides.push_back(t.has(name + ".residual.0.weight") ? 2 : 1);
  }
  NoInit zeros;
  StGcn<B> model(c, zeros);
  load_module(model, file);
  return model;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
