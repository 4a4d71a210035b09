// What train-temos, train-tmr, train-sinc, train-teach and train-actor leave, and TMR as its repository leaves it,
// behind the Generator: texts, or one action, for each motion.
#include <algorithm>

#include <motionlang/kinematics/retarget.hpp>

#include "../train/actor_model.hpp"
#include "../train/babel_model.hpp"
#include "../train/text_sources.hpp"
#include "from_actions.hpp"
#include "from_babel.hpp"

namespace program {

namespace {

using B = ml::EigenBackend<float>;

template <template <class> class System, class Config>
TextLatents<System<B>> parts_of(TextMotionModel<B, System> model, const TextModelFile<Config>& file, double longest,
                                const std::filesystem::path& folder, const std::filesystem::path& text_encoder) {
  TextLatents<System<B>> parts{.model = std::move(model.system),
                               .normalizer = std::move(model.motion_normalizer),
                               .features = &ml::motion_features(file.config.features),
                               .fps = file.fps,
                               .tokens = {},
                               .longest = longest};
  parts.tokens = [words = std::move(model.words), language = std::move(model.language),
                  states = std::make_shared<ml::EmbeddingCache>(0), asked = std::make_shared<TextStates>(), folder,
                  encoder = file.config.text.encoder, text_encoder](std::span<const std::string> texts) {
    if (words) return (*words)(texts).tokens;
    if (language) return (*language)(texts, {});
    if (text_encoder.empty())
      ml::raise<ml::config_error>(102, folder.string(), ": this model reads the states of ", encoder,
                                  ": --text-encoder names it");
    const auto is_known = [&](const std::string& text) { return states->contains(text); };
    if (!std::all_of(texts.begin(), texts.end(), is_known)) {
      if (!*asked) *asked = text_states(text_encoder);
      *states = (*asked)(texts);
    }
    return states->encode<B>(texts).tokens;
  };
  return parts;
}
template <template <class> class System>
TextLatents<System<B>> text_motion(const std::filesystem::path& folder, const TextMotionFile& file,
                                   const std::filesystem::path& text_encoder) {
  return parts_of(load_text_motion<System, B>(folder, file), file, file.config.data.max_seconds, folder, text_encoder);
}
template <template <class> class System, class Config>
TextLatents<System<B>> of_babel(const std::filesystem::path& folder, const std::filesystem::path& text_encoder) {
  const auto file = read_babel_config<Config>(folder);
  return parts_of(load_babel_model<System, B>(folder, file), file, file.config.longest_seconds(), folder, text_encoder);
}

}  // namespace

TeachLatents trained_teach(const std::filesystem::path& folder, const ModelSources& sources) {
  return of_babel<ml::Teach, TeachTrainingConfig>(folder, sources.text_encoder);
}
SincLatents trained_sinc(const std::filesystem::path& folder, const ModelSources& sources) {
  return of_babel<ml::Sinc, SincTrainingConfig>(folder, sources.text_encoder);
}

std::unique_ptr<Generator> load_trained_text_motion(const std::filesystem::path& folder, const ModelSources& sources) {
  if (ml::find_run(folder).system == "motionlang") {
    const std::string system = ml::read_model_folder(folder).system;
    if (system == "sinc") return from_sinc(trained_sinc(folder, sources));
    if (system == "teach") return from_teach(trained_teach(folder, sources));
  }
  const TextMotionFile file = read_text_motion_config(folder);
  return file.system == "tmr" ? from_texts(text_motion<ml::Tmr>(folder, file, sources.text_encoder))
                              : from_texts(text_motion<ml::Temos>(folder, file, sources.text_encoder));
}
std::unique_ptr<Generator> load_trained_actor(const std::filesystem::path& folder) {
  ActorModel<B> model(folder);
  const ActorClipsConfig clips = model.file.config.clips;
  return from_actions({.model = std::move(model.actor),
                       .labels = std::move(model.file.labels),
                       .fps = clips.fps,
                       .longest = clips.num_frames > 0 ? clips.num_frames : clips.max_len,
                       .motion_of =
                           [=](std::span<const float> rows) {
                             ml::Motion out = actor_motion(rows, clips);
                             ml::place_on_floor(out);  // its way counts from the first frame
                             return out;
                           },
                       .rows_of = actor_row_maker(clips).rows});
}

}  // namespace program
