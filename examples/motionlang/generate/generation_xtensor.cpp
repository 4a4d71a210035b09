#include <motionlang/backend/xtensor.hpp>
#include <motionlang/weights/stmc_file.hpp>

#include "generation_over.hpp"
#include "known_words.hpp"

namespace program {

std::unique_ptr<Generator> load_xtensor(const std::filesystem::path& model) {
  return make_generator(ml::load_stmc<ml::XtensorBackend<double>>(model), known_words(model));
}

}  // namespace program
