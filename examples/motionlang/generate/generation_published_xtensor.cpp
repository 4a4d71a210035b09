#include <motionlang/backend/xtensor.hpp>
#include <motionlang/weights/diffusion_run.hpp>

#include "generation_over.hpp"

namespace program {

std::unique_ptr<Generator> load_published_xtensor(const std::filesystem::path& run, const ModelSources& sources) {
  return make_generator(ml::load_diffusion_run<ml::XtensorBackend<double>>(
      ml::FilePath(run), {.text_encoder = sources.text_encoder, .statistics = sources.statistics}));
}

}  // namespace program
