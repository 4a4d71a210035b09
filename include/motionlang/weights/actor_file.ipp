// SPDX-License-Identifier: MIT
// Bodies of actor_file.hpp.
#pragma once

#include <motionlang/weights/actor_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The repository's name for a pair of networks; empty for a pair that it lacks.
inline std::string_view actor_archiname(const ActorConfig& c) {
  const bool transformer = c.encoder == ActorEncoderKind::tokens || c.encoder == ActorEncoderKind::average;
  switch (c.decoder) {
    case ActorDecoderKind::transformer:
      return transformer ? "transformer" : c.encoder == ActorEncoderKind::gru ? "grutrans" : "";
    case ActorDecoderKind::gru:
      return transformer ? "transgru" : c.encoder == ActorEncoderKind::gru ? "gru" : "";
    case ActorDecoderKind::fully_connected:
      return c.encoder == ActorEncoderKind::fully_connected ? "fc" : "";
    default:
      return transformer ? "autotrans" : "";
  }
}

MOTIONLANG_BODY ActorConfig actor_config(const RunReader& r) {
  const std::string pose = r.text("pose_rep", "rot6d");
  const std::string e = "encoder.", d = "decoder.", linear1 = ".layers.0.linear1.weight";
  ActorConfig c{.nfeats = pose == "xyz" ? 3 : size(parse_pose_representation(pose)),
                .num_heads = r.number({"num_heads"}, 4, 1024),
                .activation = parse_activation(r.one_of("activation", "gelu", {"gelu", "relu"}))};
  if (r.has(e + "muQuery")) {
    c.latent_dim = r.size(e + "muQuery", 1, {"latent_dim"});
  } else if (r.has(e + "mu_layer.weight")) {
    c.encoder = ActorEncoderKind::average;
    c.latent_dim = r.size(e + "mu_layer.weight", 0, {"latent_dim"});
  } else {
    c.encoder = r.has(e + "gru.weight_ih_l0") ? ActorEncoderKind::gru : ActorEncoderKind::fully_connected;
    c.latent_dim = r.size(e + "mu.weight", 0, {"latent_dim"});
  }
  Index features = 0;
  if (r.has(d + "finallayer.weight")) {
    const std::string ablation =
        r.one_of("ablation", "", {"", "average_encoder", "zandtime", "concat_bias", "time_encoding"});
    const bool one_hot = r.has(d + "ztimelinear.weight");
    if ((ablation == "zandtime" && !one_hot) ||
        (ablation == "average_encoder" && c.encoder != ActorEncoderKind::average))
      raise<config_error>(102, r.place("ablation"), " is '", ablation, "', but the tensors are of another one");
    features = r.size(d + "finallayer.weight", 0);
    c.num_classes = one_hot ? r.size(d + "ztimelinear.weight", 1) - c.latent_dim : r.size(d + "actionBiases", 0);
    c.conditioning = one_hot                       ? ActorConditioning::zandtime
                     : ablation == "concat_bias"   ? ActorConditioning::concat_bias
                     : ablation == "time_encoding" ? ActorConditioning::time_encoding
                                                   : ActorConditioning::action_bias;
  } else if (r.has(d + "gru.weight_ih_l0")) {
    c.decoder = ActorDecoderKind::gru;
    features = r.size(d + "final_layer.weight", 0);
    c.num_classes = r.size(d + "feats_embedding.weight", 1) - c.latent_dim - 1;
  } else if (r.has(d + "embedding_x.weight")) {
    c.decoder = ActorDecoderKind::autoregressive;
    features = r.size(d + "output_layer.weight", 0);
    c.num_classes = r.size(d + "embedding_x.weight", 1) - features - 1;
  } else {
    c.decoder = ActorDecoderKind::fully_connected;
    c.num_frames = r.number({"num_frames"}, 60, 100'000, 2);
    features = r.size(d + "fully_connected.4.weight", 0) / c.num_frames;
    c.num_classes = r.size(d + "fully_connected.0.weight", 1) - c.latent_dim;
  }
  if (const std::string stated = r.text("archiname", ""); !stated.empty() && stated != actor_archiname(c))
    raise<config_error>(102, r.place("archiname"), " is '", stated, "', the tensors are those of ", actor_archiname(c));
  if (features % c.nfeats != 0)
    raise<config_error>(102, r.place("pose_rep"), " has joints of ", counted(c.nfeats, "number"), ", frames have ",
                        features);
  c.njoints = features / c.nfeats;
  for (const auto& [before, behind] : {std::pair{e + "seqTransEncoder.layers.", ".linear1.weight"},
                                       {d + "seqTransDecoder.layers.", ".linear1.weight"},
                                       {d + "layers.", ".trg_trg_att.k_layer.weight"},
                                       {e + "gru.weight_ih_l", ""},
                                       {d + "gru.weight_ih_l", ""}}) {
    if (r.has(before + "0" + behind)) c.num_layers = r.count(before, behind, {"num_layers"});
  }
  for (const std::string& name : {e + "seqTransEncoder" + linear1, d + "seqTransDecoder" + linear1,
                                  d + "layers.0.feed_forward.pwff_layer.0.weight"}) {
    if (r.has(name)) c.ff_size = r.size(name, 0, {"ff_size"});
  }
  if (c.num_classes < 1 || c.njoints < 1)
    raise<io_error>(407, "ACTOR: the shapes of its tensors leave ", counted(c.num_classes, "class", "classes"), " and ",
                    counted(c.njoints, "joint"));
  return c;
}

MOTIONLANG_BODY GruClassifierConfig gru_classifier_config(const TensorSet& file) {
  const RunFolder no_options{};
  const RunReader t(no_options, file, "");
  return {.input_size = t.size("recurrent.weight_ih_l0", 1),
          .hidden_size = t.size("recurrent.weight_hh_l0", 1),
          .num_layers = t.count("recurrent.weight_ih_l", "", {}),
          .num_classes = t.size("linear2.weight", 0)};
}

MOTIONLANG_BODY StGcnConfig stgcn_config(const TensorSet& file) {
  const RunFolder no_options{};
  const RunReader t(no_options, file, "");
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
  return c;
}

}  // namespace detail

MOTIONLANG_BODY Index actor_longest(const RunFolder& run, const TensorSet& weights, const ActorConfig& config) {
  const detail::RunReader r(run, weights, "");
  const auto frames = [&r](const char* key, Index otherwise, Index least) {
    const Index n = r.number({key}, otherwise, 100'000, least);
    return n < 0 ? n : r.number({key}, otherwise, 100'000, 2);  // 0 and 1 frames are not a motion
  };
  const Index stated = frames("num_frames", 60, -2), most = stated < 0 ? frames("max_len", -1, -1) : stated;
  return std::min(most < 0 ? config.max_len : most, config.max_len - 2);
}

MOTIONLANG_BODY ActorFrameOptions actor_frame_options(const RunFolder& run, const TensorSet& weights) {
  const detail::RunReader r(run, weights, "");
  const std::string sampling = r.one_of("sampling", "conseq", {"conseq", "random_conseq", "random"});
  const Index step = r.number({"sampling_step"}, 1, 100'000, -1);
  if (step == 0) raise<config_error>(101, r.place("sampling_step"), " is 0, not -1 or 1 ... 100000");
  return {.random_step = sampling == "random_conseq", .step = step, .scattered = sampling == "random"};
}

MOTIONLANG_BODY ActorPointOptions actor_point_options(const RunFolder& run, const TensorSet& weights) {
  const detail::RunReader r(run, weights, "");
  const Vec3<double> turn = ActorPointOptions{}.global_rotation;
  return {
      .features = {.rotations = parse_pose_representation(r.text("pose_rep", "rot6d")),
                   .translation = r.flag("translation", true),
                   .global = r.flag("glob", true)},
      .translate = r.flag("vertstrans", false),
      .global_rotation = {r.real("glob_rot/0", turn.x), r.real("glob_rot/1", turn.y), r.real("glob_rot/2", turn.z)}};
}

MOTIONLANG_NAMESPACE_END
