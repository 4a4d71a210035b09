#include <motionlang/backend/reference.hpp>

#include "generation_over.hpp"

namespace program {

std::unique_ptr<Generator> load_reference(const std::filesystem::path& model) {
  return std::make_unique<GeneratorOver<ml::ReferenceBackend<double>>>(model);
}

}  // namespace program
