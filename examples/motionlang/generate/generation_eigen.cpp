#include <motionlang/backend/eigen.hpp>
#include <motionlang/generate/load_motion_model.hpp>

#include "generation.hpp"

namespace program {

std::unique_ptr<ml::MotionModel> load_eigen(const ml::MotionModelPlace& place, const ml::ModelSources& sources) {
  return ml::load_motion_model<ml::EigenBackend<float>>(place, {.sources = sources, .trained = load_trained});
}

}  // namespace program
