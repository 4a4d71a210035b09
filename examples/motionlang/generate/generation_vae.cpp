// ACTOR and TEMOS, as their repositories leave them, behind the Generator: one text, or one action, for each motion.
#include <motionlang/weights/vae_run.hpp>

#include "from_actions.hpp"
#include "from_texts.hpp"

namespace program {

using B = ml::EigenBackend<float>;

std::unique_ptr<Generator> load_actor(const std::filesystem::path& run) {
  auto actor = ml::load_actor_run<B>(ml::FilePath(run));
  const ml::ActorFeatureOptions options = actor.features;
  const double fps = 20;  // the viewer's, of the repository; data have none
  return from_actions(
      {.model = std::move(actor.model),
       .labels = std::move(actor.labels),
       .fps = fps,
       .longest = actor.longest,
       .motion_of =
           [=](std::span<const float> rows) { return ml::motion_of_actor(ml::actor_inverse(rows, 24, options), fps); },
       .rows_of = [=](const ml::Motion& motion) { return ml::actor_rows_of_motion(motion, options); }});
}
std::string system_of_run(const std::filesystem::path& run) {
  const ml::RunFolder folder = ml::find_run(run);
  if (folder.system != "temos" || folder.weights.empty()) return folder.system;
  return ml::lightning_system(ml::open_weights(folder.weights));
}
std::unique_ptr<Generator> load_temos(const std::filesystem::path& run, const ModelSources& sources) {
  const std::string system = system_of_run(run);
  if (system == "teach") return load_teach(run, sources);
  if (system == "sinc") return load_sinc(run, sources);
  return from_texts(text_latents(ml::load_temos_run<B>(
      ml::find_run(run), {.text_encoder = sources.text_encoder, .statistics = sources.statistics})));
}

}  // namespace program
