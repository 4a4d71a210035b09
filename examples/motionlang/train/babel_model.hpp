// A trained SINC or TEACH: how it is made, and its folder, which is that of text_motion_model.hpp.
#pragma once

#include <motionlang/systems/sinc.hpp>
#include <motionlang/systems/teach.hpp>

#include "babel_config.hpp"
#include "text_motion_model.hpp"

namespace program {

template <>
constexpr const char* system_name<ml::Sinc>() {
  return "sinc";
}
template <>
constexpr const char* system_name<ml::Teach>() {
  return "teach";
}

inline ml::SincConfig system_config(const SincTrainingConfig& c, ml::Index width) {
  return babel_network<ml::SincConfig>(c.network, width, c.text.width);
}
inline ml::TeachConfig system_config(const TeachTrainingConfig& c, ml::Index width) {
  auto out = babel_network<ml::TeachConfig>(c.network, width, c.text.width);
  out.hist_frames = c.network.hist_frames, out.z_prev_text = c.network.z_prev_text;
  out.mask_padding = c.network.mask_padding;
  return out;
}
/// eps of the normalisation.
inline double normalizer_eps(const SincTrainingConfig&) { return ml::sinc_eps; }
inline double normalizer_eps(const TeachTrainingConfig&) { return 1e-12; }

/// What config.json of train-sinc or train-teach says. Throws io_error 401, 403, config_error 101, 103, 107.
template <class Config>
TextModelFile<Config> read_babel_config(const std::filesystem::path& folder) {
  return text_model_file<Config>(ml::read_model_folder(folder), (folder / "config.json").string());
}

/// New weights, with statistics that change nothing. Throws config_error 101, 103 for sizes and options that cannot be.
template <template <class> class System, ml::Backend B, class Config>
TextMotionModel<B, System> make_babel_model(const Config& c, ml::Index width, std::optional<ml::WordPiece> pieces,
                                            const ml::Philox& rng) {
  TextMotionModel<B, System> m;
  auto init = rng.split("system"), words = rng.split("words");
  m.system = System<B>(system_config(c, width), init);
  if (pieces) m.words.emplace(std::move(*pieces), c.text.width, words);
  m.motion_normalizer = ml::Normalizer<B>::identity(width);
  m.motion_normalizer.eps = normalizer_eps(c);
  return m;
}

/// Throws what the readers throw.
template <template <class> class System, ml::Backend B, class Config>
TextMotionModel<B, System> load_babel_model(const std::filesystem::path& folder, const TextModelFile<Config>& file) {
  const auto weights = ml::open_weights(folder);
  const auto room = ml::detail::room_of(weights);
  auto model = make_babel_model<System, B>(file.config, ml::motion_features(file.config.features).width, file.pieces,
                                           ml::Philox{});
  ml::load_module(model, weights);
  ml::prepare(model);
  return model;
}

}  // namespace program
