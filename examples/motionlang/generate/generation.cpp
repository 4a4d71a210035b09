#include "generation.hpp"

namespace program {

#ifndef MOTIONLANG_TRAINING
std::unique_ptr<ml::MotionModel> load_trained(const ml::MotionModelPlace& place, const ml::ModelSources&) {
  ml::raise<usage_error>(103, place.path.string(),
                         ": models of train-actor, train-temos, train-sinc, train-teach and train-tmr, and TMR, need "
                         "a program with training "
                         "(-DMOTIONLANG_TRAINING=ON)");
}
#endif

std::unique_ptr<ml::MotionModel> load_generator(const std::string& backend, const std::filesystem::path& path,
                                                const ml::ModelSources& sources) {
  const ml::MotionModelPlace place = ml::find_motion_model(path);
  const std::string model = place.path.string();
#ifndef MOTIONLANG_TRAINING
  if (place.is_trained()) return load_trained(place, sources);  // reports what is missing
#endif
  if (!place.is_diffusion() && backend != "eigen")
    ml::raise<usage_error>(103, model, " (", place.system, ") is generated with backend 'eigen', not '", backend, "'");
  if (backend == "eigen") return load_eigen(place, sources);
  if (backend == "xtensor") return load_xtensor(place, sources);
  if (backend == "reference") return load_reference(place, sources);
  ml::raise<usage_error>(103, "backend '", backend, "' is not one of eigen, xtensor, reference");
}

const ml::LatentMotionModel& require_latent(const ml::MotionModel& generator, const std::string& option,
                                            const std::filesystem::path& model) {
  if (generator.latent() == nullptr)
    ml::raise<usage_error>(102, model.string(), ": ", option,
                           " is for models with one latent for every motion (ACTOR, TEMOS, TMR, SINC); this is ",
                           generator.system());
  return *generator.latent();
}

CLI::Option* sampler_option(CLI::App& command, std::string& sampler) {
  const std::vector<std::string> names(ml::sampler_names.begin(), ml::sampler_names.end());
  return command
      .add_option("--sampler", sampler,
                  "Sampler. The default is what the weights ask for. plms needs many steps: --steps 0")
      ->check(CLI::IsMember(names));
}

}  // namespace program
