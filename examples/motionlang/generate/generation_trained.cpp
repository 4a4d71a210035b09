// Models of our trainings, and TMR. This unit takes as long to compile as all other models.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/generate/load_trained_motion_model.hpp>

#include "generation.hpp"

namespace program {

std::unique_ptr<ml::MotionModel> load_trained(const ml::MotionModelPlace& place, const ml::ModelSources& sources) {
  return ml::load_trained_motion_model<ml::EigenBackend<float>>(place, sources);
}

}  // namespace program
