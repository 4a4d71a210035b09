#include <motionlang/backend/eigen.hpp>

#include "generation_over.hpp"

namespace program {

std::unique_ptr<Generator> load_eigen(const std::filesystem::path& model) {
  return std::make_unique<GeneratorOver<ml::EigenBackend<float>>>(model);
}

}  // namespace program
