// SPDX-License-Identifier: MIT
// Bodies of actor_model.hpp.
#pragma once

#include <motionlang/weights/actor_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The number of a name in a list. Throws config_error 103.
template <class E, std::size_t N>
E choice(const std::string& name, const char* key, const std::array<const char*, N>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) raise<config_error>(103, key, " '", name, "' is not one of ", join_text(names));
  return static_cast<E>(found - names.begin());
}

}  // namespace detail

MOTIONLANG_BODY ActorConfig actor_sizes(const ActorTrainingConfig& c, Index classes) {
  const auto& n = c.network;
  return {.njoints = c.clips.joints(),
          .nfeats = c.clips.numbers(),
          .num_classes = classes,
          .latent_dim = n.latent_dim,
          .ff_size = n.ff_size,
          .num_layers = n.num_layers,
          .num_heads = n.num_heads,
          .dropout = n.dropout,
          .activation = parse_activation(n.activation),
          .encoder = detail::choice<ActorEncoderKind>(n.encoder, "network.encoder", actor_encoder_names),
          .decoder = detail::choice<ActorDecoderKind>(n.decoder, "network.decoder", actor_decoder_names),
          .conditioning =
              detail::choice<ActorConditioning>(n.conditioning, "network.conditioning",
                                                std::array{"action_bias", "concat_bias", "zandtime", "time_encoding"}),
          .concatenate_time = n.concatenate_time,
          .num_frames = std::max<Index>(1, c.clips.num_frames)};
}

MOTIONLANG_BODY void require_same_clips(const ActorClipsConfig& model, const ActorClipsConfig& seen) {
  const auto text_of = [](const ActorClipsConfig& c) {
    return concat_text("fps ", c.fps, ", turned_ahead ", c.turned_ahead ? "true" : "false", ", translation ",
                       c.translation ? "true" : "false", ", global ", c.global ? "true" : "false");
  };
  if (model.fps != seen.fps || model.turned_ahead != seen.turned_ahead || (seen.translation && !model.translation) ||
      (seen.global && !model.global))
    raise<config_error>(102, "model and classifier have different clips: ", text_of(model), " and ", text_of(seen));
}

MOTIONLANG_BODY void require_same_rows(const ActorClipsConfig& model, const ActorClipsConfig& clips) {
  const auto text_of = [](const ActorClipsConfig& c) {
    return concat_text("pose ", c.pose, ", translation ", c.translation ? "true" : "false", ", global ",
                       c.global ? "true" : "false", ", camera ", c.camera ? "true" : "false");
  };
  if (text_of(model) != text_of(clips))
    raise<config_error>(102, "the model to start from has other clips: ", text_of(model), "; the settings say ",
                        text_of(clips));
}

MOTIONLANG_BODY std::vector<Index> numbers_of(std::span<const std::string> actions,
                                              std::span<const std::string> classifier) {
  if (!std::is_permutation(actions.begin(), actions.end(), classifier.begin(), classifier.end()))
    raise<config_error>(102, "model and classifier have different labels: ", join_text(actions), "; and ",
                        join_text(classifier));
  std::vector<Index> out;
  for (const std::string& action : actions)
    out.push_back(std::find(classifier.begin(), classifier.end(), action) - classifier.begin());
  return out;
}

MOTIONLANG_BODY std::vector<std::string> class_names(std::string_view dataset, Index classes) {
  auto names = action_labels(dataset, classes);
  for (Index i = std::ssize(names); i < classes; ++i) names.push_back(std::to_string(i));
  return names;
}

MOTIONLANG_BODY ActionModelFile<ActorTrainingConfig> published_actor_file(
    const ActorConfig& sizes, const std::optional<ActorFeatureOptions>& rotations, const ActorFrameOptions& frames,
    ActorPoints points, std::vector<std::string> labels, const std::string& name) {
  if (rotations && !rotations->global)
    raise<config_error>(102, name, ": glob is false: motions without the rotation of joint 0 are not measured");
  ActionModelFile<ActorTrainingConfig> file;
  ActorClipsConfig& clips = file.config.clips;
  clips = published_actor_clips(rotations);
  clips.num_frames = sizes.num_frames;
  clips.sampling_step = frames.step;
  clips.random_step = frames.random_step, clips.random_frames = frames.scattered;
  file.config.losses.points = std::string(actor_point_names[static_cast<std::size_t>(points)]);
  file.config.data = {.min_seconds = 0.2, .max_seconds = 1000};  // as the published program has it
  file.labels = labels.empty() ? class_names("", sizes.num_classes) : std::move(labels);
  return file;
}

MOTIONLANG_NAMESPACE_END
