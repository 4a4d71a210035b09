#include "actor_model.hpp"

#include <motionlang/weights/vae_run.hpp>

namespace program {

using ml::Index;

namespace {

/// The number of a name in a list. Throws config_error 103.
template <class E, std::size_t N>
E choice(const std::string& name, const char* key, const std::array<const char*, N>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) ml::raise<ml::config_error>(103, key, " '", name, "' is not one of ", ml::join_text(names));
  return static_cast<E>(found - names.begin());
}

}  // namespace

ml::ActorConfig actor_sizes(const ActorTrainingConfig& c, Index classes) {
  const auto& n = c.network;
  return {.njoints = c.clips.joints(),
          .nfeats = c.clips.numbers(),
          .num_classes = classes,
          .latent_dim = n.latent_dim,
          .ff_size = n.ff_size,
          .num_layers = n.num_layers,
          .num_heads = n.num_heads,
          .dropout = n.dropout,
          .activation = ml::parse_activation(n.activation),
          .encoder = choice<ml::ActorEncoderKind>(n.encoder, "network.encoder",
                                                  std::array{"tokens", "average", "gru", "fully_connected"}),
          .decoder = choice<ml::ActorDecoderKind>(
              n.decoder, "network.decoder", std::array{"transformer", "gru", "fully_connected", "autoregressive"}),
          .conditioning =
              choice<ml::ActorConditioning>(n.conditioning, "network.conditioning",
                                            std::array{"action_bias", "concat_bias", "zandtime", "time_encoding"}),
          .concatenate_time = n.concatenate_time,
          .num_frames = std::max<Index>(1, c.clips.num_frames)};
}

std::vector<Index> others_of_class(std::span<const Index> which, std::span<const Index> classes, ml::Philox& rng) {
  std::vector<Index> out;
  for (const Index i : which) {
    std::vector<Index> others;
    for (Index k = 0; k < std::ssize(classes); ++k) {
      if (k != i && classes[static_cast<std::size_t>(k)] == classes[static_cast<std::size_t>(i)]) others.push_back(k);
    }
    out.push_back(others.empty() ? i : others[rng.below(static_cast<std::uint32_t>(others.size()))]);
  }
  return out;
}

void require_same_clips(const ActorClipsConfig& model, const ActorClipsConfig& seen) {
  const auto told = [](const ActorClipsConfig& c) {
    return ml::concat_text("fps ", c.fps, ", turned_ahead ", c.turned_ahead ? "true" : "false", ", translation ",
                           c.translation ? "true" : "false", ", global ", c.global ? "true" : "false");
  };
  if (model.fps != seen.fps || model.turned_ahead != seen.turned_ahead || (seen.translation && !model.translation) ||
      (seen.global && !model.global))
    ml::raise<ml::config_error>(102, "model and classifier have other clips: ", told(model), " and ", told(seen));
}

void require_same_rows(const ActorClipsConfig& model, const ActorClipsConfig& clips) {
  const auto told = [](const ActorClipsConfig& c) {
    return ml::concat_text("pose ", c.pose, ", translation ", c.translation ? "true" : "false", ", global ",
                           c.global ? "true" : "false", ", camera ", c.camera ? "true" : "false");
  };
  if (told(model) != told(clips))
    ml::raise<ml::config_error>(102, "the model to go on from has other clips: ", told(model), "; the settings say ",
                                told(clips));
}

std::vector<Index> numbers_of(std::span<const std::string> actions, std::span<const std::string> classifier) {
  if (!std::is_permutation(actions.begin(), actions.end(), classifier.begin(), classifier.end()))
    ml::raise<ml::config_error>(102, "model and classifier have other labels: ", ml::join_text(actions), "; and ",
                                ml::join_text(classifier));
  std::vector<Index> out;
  for (const std::string& action : actions)
    out.push_back(std::find(classifier.begin(), classifier.end(), action) - classifier.begin());
  return out;
}

std::vector<std::string> class_names(std::string_view dataset, Index classes) {
  auto names = ml::action_labels(dataset, classes);
  for (Index i = std::ssize(names); i < classes; ++i) names.push_back(std::to_string(i));
  return names;
}

PublishedActor read_published_actor(const ml::RunFolder& run) {
  auto actor = ml::load_actor_run<ml::EigenBackend<float>>(run);
  if (!actor.features.global)
    ml::raise<ml::config_error>(102, run.options_file.string(),
                                ": glob is false: motions without the rotation of joint 0 are not measured");
  PublishedActor out{{}, std::move(actor.model)};
  const ml::ActorConfig& sizes = out.actor.config;
  ActorClipsConfig& clips = out.file.config.clips;
  clips.pose = std::string(ml::pose_representation_names[static_cast<std::size_t>(actor.features.rotations)]);
  clips.translation = actor.features.translation;
  clips.turned_ahead = false, clips.camera = true, clips.fps = 20;
  clips.num_frames = sizes.num_frames;
  clips.sampling_step = actor.frames.step;
  clips.random_step = actor.frames.random_step, clips.random_frames = actor.frames.scattered;
  out.file.config.losses.points = std::string(ml::actor_point_names[static_cast<std::size_t>(actor.points)]);
  out.file.config.data = actor_preset("actor-published").data;
  out.file.labels = actor.labels.empty() ? class_names("", sizes.num_classes) : std::move(actor.labels);
  return out;
}

}  // namespace program
