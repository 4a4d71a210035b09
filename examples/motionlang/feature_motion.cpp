#include "feature_motion.hpp"

#include <numbers>
#include <span>

#include <motionlang/io/motion_npy.hpp>

namespace program {

ml::Motion motion_of_features(const std::string& layout, const std::vector<double>& rows, ml::Index width, double fps) {
  if (layout == "smplrifke") return ml::smplrifke_to_motion<double>(rows, {.first_angle = std::numbers::pi}, fps);
  if (layout != "guoh3dfeats")
    ml::raise<ml::config_error>(103, "features '", layout, "' are neither smplrifke nor guoh3dfeats");
  const auto frames = static_cast<ml::Index>(rows.size()) / width;
  return ml::motion_from_array(ml::NpyArray::of(std::span<const double>(rows), {frames, width}), {.fps = fps});
}

}  // namespace program
