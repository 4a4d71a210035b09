#include "actor_model.hpp"

namespace program {

namespace {

/// The number of a name in a list. Throws config_error 103.
template <class E, std::size_t N>
E choice(const std::string& name, const char* key, const std::array<const char*, N>& names) {
  std::string all;
  for (std::size_t i = 0; i < N; ++i) {
    if (name == names[i]) return static_cast<E>(i);
    all += (i == 0 ? "" : ", ") + std::string(names[i]);
  }
  ml::raise<ml::config_error>(103, key, " '", name, "' is none of ", all);
}

}  // namespace

ml::ActorConfig actor_sizes(const ActorTrainingConfig& c, ml::Index classes) {
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
          .num_frames = std::max<ml::Index>(1, c.clips.num_frames)};
}

std::vector<ml::Index> others_of_class(std::span<const ml::Index> which, std::span<const ml::Index> classes,
                                       ml::Philox& rng) {
  std::vector<ml::Index> out;
  for (const ml::Index i : which) {
    std::vector<ml::Index> others;
    for (ml::Index k = 0; k < std::ssize(classes); ++k) {
      if (k != i && classes[static_cast<std::size_t>(k)] == classes[static_cast<std::size_t>(i)]) others.push_back(k);
    }
    out.push_back(others.empty() ? i : others[rng.below(static_cast<std::uint32_t>(others.size()))]);
  }
  return out;
}

void require_same_actions(const ActionModelFile<ActorTrainingConfig>& model, std::span<const std::string> labels,
                          const ActorClipsConfig& seen) {
  const ActorClipsConfig& clips = model.config.clips;
  if (!std::equal(labels.begin(), labels.end(), model.labels.begin(), model.labels.end()))
    ml::raise<ml::config_error>(102, "model and classifier have other labels");
  if (clips.fps != seen.fps || clips.turned_ahead != seen.turned_ahead ||
      (clips.translation != seen.translation && seen.translation) || (clips.global != seen.global && seen.global))
    ml::raise<ml::config_error>(102, "model and classifier have other clips (fps, turned_ahead, translation, global)");
}

}  // namespace program
