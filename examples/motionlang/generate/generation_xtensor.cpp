#include <motionlang/backend/xtensor.hpp>
#include <motionlang/generate/load_motion_model.hpp>

#include "generation.hpp"

namespace program {

std::unique_ptr<ml::MotionModel> load_xtensor(const ml::MotionModelPlace& place, const ml::ModelSources& sources) {
  return ml::load_diffusion_motion_model<ml::XtensorBackend<double>>(place, sources);
}

}  // namespace program
