#include <motionlang/backend/xtensor.hpp>

#include "generation_over.hpp"

namespace program {

std::unique_ptr<Generator> load_xtensor(const std::filesystem::path& model) {
  return std::make_unique<GeneratorOver<ml::XtensorBackend<double>>>(model);
}

}  // namespace program
