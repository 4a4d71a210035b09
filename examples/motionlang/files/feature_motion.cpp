#include "feature_motion.hpp"

#include <numbers>
#include <span>

#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>

namespace program {

const ml::MotionFeatures& features_of_layout(const std::string& layout, ml::Index width) {
  if (layout != "guoh3dfeats") return ml::motion_features(layout);
  const ml::MotionFeatures& kit = ml::motion_features("kit");
  return width == kit.width ? kit : ml::motion_features("guoh3d");
}

ml::Motion motion_of_features(const std::string& layout, const std::vector<double>& rows, ml::Index width, double fps) {
  if (layout == "smplrifke") return ml::smplrifke_to_motion<double>(rows, {.first_angle = std::numbers::pi}, fps);
  return ml::motion_of_rows(features_of_layout(layout, width), rows, fps);
}

ml::Motion motion_of_features(const ml::MotionFeatures& features, std::span<const float> rows, double fps) {
  const std::vector<double> values(rows.begin(), rows.end());
  return ml::motion_of_rows(features, values, fps);
}

std::vector<ml::Motion> EachAlone::run(const std::vector<ml::Timeline>& timelines, const GenerationSettings& settings,
                                       ml::Progress progress) const {
  require_no_noise(settings);
  require_steps(settings, *this);
  std::vector<ml::Motion> motions;
  for (std::size_t m = 0; m < timelines.size(); ++m) {
    motions.push_back(finished(motion(timelines[m], noise_of(settings, m), settings), settings));
    progress(static_cast<ml::Index>(m) + 1, static_cast<ml::Index>(timelines.size()));
  }
  return motions;
}

ml::Motion finished(ml::Motion motion, const GenerationSettings& settings) {
  if (settings.smooth) motion = ml::smooth_motion(motion);
  const auto legs = ml::known_legs(motion.skeleton);
  if (settings.fix_feet && !legs.empty()) motion = ml::fix_feet(motion, legs);  // last: feet that stand are to be still
  return motion;
}

}  // namespace program
