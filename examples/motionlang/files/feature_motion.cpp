#include "feature_motion.hpp"

#include <numbers>
#include <span>

#include <motionlang/io/motion_npy.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/motion_from_joints.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>

namespace program {

namespace {

/// TEMOS's 64 numbers: the 21 joints of MMM, Y up.
ml::Motion mmm_motion(std::span<const double> rows, double fps) {
  const auto joints = ml::rifke_joints(ml::temos_rifke(), rows);
  std::vector<double> numbers;
  for (const auto& p : joints) numbers.insert(numbers.end(), {p.x, p.y, p.z});
  const auto frames = static_cast<ml::Index>(joints.size()) / 21;
  return ml::motion_from_array(ml::NpyArray::of(std::span<const double>(numbers), {frames, 21, 3}),
                               {.fps = fps, .up = ml::UpAxis::y});
}

}  // namespace

ml::Motion motion_of_features(const std::string& layout, const std::vector<double>& rows, ml::Index width, double fps) {
  if (layout == "smplrifke") return ml::smplrifke_to_motion<double>(rows, {.first_angle = std::numbers::pi}, fps);
  if (layout == "smplvelp") return ml::motion_features(layout).to_motion(rows, fps);
  if (layout == "rifke") return mmm_motion(rows, fps);
  if (layout != "guoh3dfeats")
    ml::raise<ml::config_error>(103, "features '", layout, "' are none of smplrifke, guoh3dfeats, rifke, smplvelp");
  const auto frames = static_cast<ml::Index>(rows.size()) / width;
  return ml::motion_from_array(ml::NpyArray::of(std::span<const double>(rows), {frames, width}), {.fps = fps});
}

ml::Motion motion_of_features(const ml::MotionFeatures& features, std::span<const float> rows) {
  const std::vector<double> values(rows.begin(), rows.end());
  if (features.to_motion != nullptr) return features.to_motion(values, features.fps);
  return ml::motion_from_joints(ml::smpl24_skeleton(), features.joints_of(values), features.joints, features.fps);
}

std::vector<ml::Motion> EachAlone::run(const std::vector<ml::Timeline>& timelines, const GenerationSettings& settings,
                                       ml::Progress progress) const {
  require_no_noise(settings);
  const auto noise = ml::Philox{.seed = settings.seed}.split("noise");
  std::vector<ml::Motion> motions;
  for (std::size_t m = 0; m < timelines.size(); ++m) {
    motions.push_back(finished(motion(timelines[m], noise.split(m), settings), settings));
    progress(static_cast<ml::Index>(m) + 1, static_cast<ml::Index>(timelines.size()));
  }
  return motions;
}

ml::Motion finished(ml::Motion motion, const GenerationSettings& settings) {
  if (settings.smooth) motion = ml::smooth_motion(motion);
  const bool on_smpl = motion.skeleton.names == ml::smpl24_skeleton().names;
  if (settings.fix_feet && on_smpl) motion = ml::fix_feet(motion);  // last: feet that stand are to be still
  return motion;
}

}  // namespace program
